// The command line: one file per command; here only what they share.
#include <exception>
#include <string>

#include "ajar/campaign/run.hpp"
#include "ajar/core/error.hpp"
#include "commands.hpp"
#include "complain.hpp"
#include "exit_codes.hpp"

namespace {

int parse_and_run(CLI::App& program, int argc, char** argv, const int& exit_code) {
  try {
    program.parse(argc, argv);
    return exit_code;
  } catch (const CLI::Success& asked) {  // --help, --version
    return program.exit(asked);
  } catch (const CLI::RequiredError& error) {
    const bool unknown = argc > 1 && program.get_subcommands().empty();
    complain(unknown ? std::string("unknown command '") + argv[1] +
                           "'; allowed: run, campaign, identify, validate, report, view, reproduce"
                     : std::string(error.what()) + " (see ajar --help)");
    return kBadInput;
  } catch (const CLI::ParseError& error) {
    complain(std::string(error.what()) + " (see ajar --help)");
    return kBadInput;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    int exit_code = kReached;
    CLI::App program{"Opens doors and drawers that nobody described to it, in simulation.", "ajar"};
    program.set_version_flag("--version", ajar::version());
    program.require_subcommand(1);
    program.footer(
        "Exit codes: 0 the goal was reached, 1 the mission ended safely without reaching it,\n"
        "2 bad input or usage, 3 a fault of the program.");
    add_run(program, exit_code);
    add_campaign(program, exit_code);
    add_identify(program, exit_code);
    add_validate(program, exit_code);
    add_report(program, exit_code);
    add_view(program, exit_code);
    add_reproduce(program, exit_code);
    return parse_and_run(program, argc, argv, exit_code);
  } catch (const ajar::Error& error) {
    complain(error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    complain(std::string("a fault of the program: ") + error.what());
    return kOurFault;
  }
}
