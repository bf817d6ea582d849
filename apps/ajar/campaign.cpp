#include "ajar/campaign/campaign.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "plants.hpp"
#include "progress.hpp"

namespace {

namespace fs = std::filesystem;

struct CampaignArguments {
  std::string campaign;
  std::optional<int> runs;
  std::optional<std::uint64_t> seed;
  int jobs = 0;
  std::optional<int> replay;
  std::string out;
  ajar::Keep keep = ajar::Keep::Failed;
  bool resume = false;
  bool quiet = false;
};

fs::path campaign_folder(const CampaignArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  // A stable name, so that --resume finds it again without --out.
  return fs::path("runs") / fs::path(arguments.campaign).stem();
}

ajar::RunResult run_one(const ajar::Scenario& scenario, const ajar::RunOptions& options) {
  return ajar::run_mission(scenario, make_plant, options);
}

/// One run again, with its folder; the campaign's rows stay as they are.
int replay(const ajar::Campaign& campaign, int index, const CampaignArguments& arguments) {
  ajar::RunOptions options;
  options.folder = ajar::run_folder(campaign_folder(arguments), index);
  options.stop = &interrupted();
  const ajar::RunResult result = ajar::replay_run(campaign, index, run_one, options);
  fmt::print("{} ({} in phase {})\n{}\n", result.outcome, result.reason, result.phase,
             (options.folder / "report.html").string());
  return result.exit_code();
}

int run_all(const CampaignArguments& arguments) {
  ajar::Campaign campaign = ajar::load_campaign(arguments.campaign);
  if (arguments.runs) campaign.runs = *arguments.runs;
  if (arguments.seed) campaign.seed = *arguments.seed;

  if (arguments.replay) return replay(campaign, *arguments.replay, arguments);

  CampaignTicker ticker;
  ajar::CampaignOptions options;
  options.out = campaign_folder(arguments);
  options.jobs = arguments.jobs;
  options.keep = arguments.keep;
  options.resume = arguments.resume;
  options.stop = &interrupted();
  if (!arguments.quiet) options.progress = [&](const ajar::CampaignProgress& progress) { ticker.tell(progress); };
  const ajar::CampaignSummary summary = ajar::run_campaign(campaign, run_one, options);
  ticker.finish();
  fmt::print("{}", ajar::format_summary(summary));
  fmt::print("rows in {}, page in {}\n", (options.out / "runs.csv").string(), (options.out / "report.html").string());
  return options.stop->load() ? kNotReached : kReached;
}

}  // namespace

void add_campaign(CLI::App& program, int& exit_code) {
  CLI::App* const command =
      program.add_subcommand("campaign", "Many runs, sampled or listed; writes runs.csv and summary.json");
  const auto arguments = std::make_shared<CampaignArguments>();
  const std::map<std::string, ajar::Keep> keep{
      {"failed", ajar::Keep::Failed}, {"all", ajar::Keep::All}, {"none", ajar::Keep::None}};
  command->add_option("CAMPAIGN", arguments->campaign, "Campaign file (TOML)")->required();
  command->add_option("--runs", arguments->runs, "Number of runs instead of the file's")->check(CLI::Range(1, 100000000));
  command->add_option("--jobs", arguments->jobs, "Threads; 0 = one per processor")->check(CLI::Range(0, 4096));
  command->add_option("--seed", arguments->seed, "Seed instead of the file's");
  command->add_option("--keep", arguments->keep, "Run folders to keep: failed, all or none")
      ->transform(CLI::CheckedTransformer(keep));
  command->add_option("--replay", arguments->replay, "Makes run NUMBER again, with its folder and page, and nothing else");
  command->add_option("--out", arguments->out, "Folder; default runs/CAMPAIGN");
  command->add_flag("--resume", arguments->resume, "Go on where a campaign was broken off");
  command->add_flag("--quiet", arguments->quiet, "No progress on standard error");
  command->callback([arguments, &exit_code] { exit_code = run_all(*arguments); });
}
