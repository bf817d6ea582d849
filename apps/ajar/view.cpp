#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "ajar/campaign/campaign.hpp"
#include "ajar/core/error.hpp"
#include "ajar/report/report.hpp"
#include "commands.hpp"
#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "local_server.hpp"
#include "plants.hpp"

namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  std::vector<std::string> folders;
  bool live = false;
};

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// The replays of a campaign; one that was not kept is made again when somebody asks for it, one at a time.
class Replays {
 public:
  explicit Replays(fs::path folder) : folder_(std::move(folder)) {}

  Answer answer(const std::string& number) {
    if (number.empty() || number.size() > 8) return {404, "text/plain", "ajar: no such run\n"};
    const int index = std::stoi(number);
    const fs::path page = ajar::run_folder(folder_, index) / "report.html";
    const std::lock_guard lock(mutex_);
    if (!fs::exists(page)) make(index);
    return {200, "text/html; charset=utf-8", read_text(page)};
  }

 private:
  void make(int index) {
    const ajar::CampaignOrigin origin = ajar::read_campaign_origin(folder_);
    ajar::Campaign campaign = ajar::load_campaign(origin.file);
    campaign.seed = origin.seed;
    campaign.runs = std::max(campaign.runs, index + 1);  // the campaign may have been asked for more runs than its file
    ajar::RunOptions options;
    options.folder = ajar::run_folder(folder_, index);
    options.stop = &interrupted();
    const auto one = [](const ajar::Scenario& scenario, const ajar::RunOptions& run_options) {
      return ajar::run_mission(scenario, make_plant, run_options);
    };
    static_cast<void>(ajar::replay_run(campaign, index, one, options));
  }

  fs::path folder_;
  std::mutex mutex_;
};

fs::path newest_live_run() {
  fs::path newest;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator("runs", missing)) {
    const fs::path file = entry.path() / "live.json";
    if (!fs::exists(file, missing)) continue;
    if (newest.empty() || fs::last_write_time(file) > fs::last_write_time(newest / "live.json")) newest = entry.path();
  }
  if (newest.empty()) throw ajar::IoError("runs: no run goes on here that was started with --live");
  return newest;
}

int serve(const std::vector<fs::path>& folders) {
  const std::atomic<bool>& stop = interrupted();
  const bool campaign = folders.size() == 1 && fs::exists(folders.front() / "runs.csv");
  const auto make = [=] { return campaign ? ajar::make_campaign_page(folders.front()) : ajar::make_report(folders); };
  static_cast<void>(make());  // what cannot be shown is told here and not in the browser
  Replays replays(folders.front());
  LocalServer server;
  server.on_get("", [&](const std::string&) { return Answer{200, "text/html; charset=utf-8", make()}; });
  if (campaign) server.on_get("replay/", [&](const std::string& number) { return replays.answer(number); });
  server.start();
  fmt::print("{}\n", server.address());
  fmt::print(stderr, "open it in a browser of this computer; Ctrl-C ends\n");
  std::fflush(stdout);
  while (!stop) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return kReached;
}

int view(const ViewArguments& arguments) {
  const std::vector<fs::path> folders(arguments.folders.begin(), arguments.folders.end());
  if (arguments.live) {
    if (folders.size() > 1) throw CLI::ValidationError("view --live", "one run folder at most");
    fmt::print("{}\n", live_address(folders.empty() ? newest_live_run() : folders.front()));
    return kReached;
  }
  if (folders.empty()) throw CLI::RequiredError("FOLDER");
  for (const fs::path& folder : folders) {
    if (!fs::is_directory(folder)) throw ajar::IoError(folder.string() + ": no such folder; allowed: a run or a campaign");
  }
  return serve(folders);
}

}  // namespace

void add_view(CLI::App& program, int& exit_code) {
  CLI::App* const command =
      program.add_subcommand("view", "Serves the page of a run, of several, or of a campaign to this computer");
  const auto arguments = std::make_shared<ViewArguments>();
  command->add_option("FOLDER", arguments->folders, "Folder of a run or campaign; several runs are compared");
  command->add_flag("--live", arguments->live,
                    "Prints where a run that goes on can be watched; default the newest in runs/");
  command->callback([arguments, &exit_code] { exit_code = view(*arguments); });
}
