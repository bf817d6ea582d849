#include "ajar/campaign/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <mutex>
#include <thread>

#include "ajar/core/error.hpp"
#include "ajar/log/csv_table.hpp"
#include "ajar/report/report.hpp"

namespace ajar {
namespace {

/// Row of a run that came to a result or threw.
struct Row {
  std::string text;
  bool opened = false;
};

std::string join_row(int index, std::uint64_t seed, int exit_code, const std::vector<ResultField>& drawn,
                     const std::vector<ResultField>& result) {
  std::string text = fmt::format("{},{},{}", index, seed, exit_code);
  const auto append = [&](const ResultField& field) {
    text += ',';
    text += csv_cell(field);
  };
  for (const ResultField& field : drawn) append(field);
  for (const ResultField& field : result) {
    if (field.name != "seed") append(field);
  }
  text += '\n';
  return text;
}

std::string header_row(const Campaign& campaign) {
  std::string text = "run,seed,exit_code";
  const auto append = [&](const std::string& name) {
    text += ',';
    text += csv_cell(std::string_view(name));
  };
  for (const ResultField& field : make_run(campaign, 0).drawn) append(field.name);
  for (const ResultField& field : result_fields(RunResult{})) {
    if (field.name != "seed") append(field.name);
  }
  text += '\n';
  return text;
}

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// runs.csv: rows arrive in any order and leave in the order of the runs.
class RowFile {
 public:
  RowFile(const Campaign& campaign, const CampaignOptions& options) : file_(options.out / "runs.csv") {
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    if (error || !std::filesystem::is_directory(options.out))
      throw IoError("cannot make the folder '" + options.out.string() + "'");
    const std::string header = header_row(campaign);
    const std::string identity = fmt::format("# seed {}\n{}", campaign.seed, campaign.text);
    const std::filesystem::path copy = options.out / "campaign.toml";
    if (std::filesystem::exists(file_)) {
      if (!options.resume) throw ConfigError(file_.string() + " exists: allowed: --resume, or another --out");
      if (read_text(copy) != identity)
        throw ConfigError(copy.string() + " differs from this campaign: allowed: --resume of the same file and seed");
      next_ = cut_to_complete_rows(header);
    } else {
      std::ofstream(copy, std::ios::binary) << identity;
      std::ofstream(file_, std::ios::binary) << header;
    }
    write_campaign_origin(options.out, {campaign.file, campaign.seed});
    stream_.open(file_, std::ios::binary | std::ios::app);
    if (!stream_ || !std::filesystem::exists(copy)) throw IoError("cannot write '" + file_.string() + "'");
  }

  /// First run that has no row yet.
  [[nodiscard]] int next() const noexcept { return next_; }
  [[nodiscard]] int opened() const noexcept { return opened_; }
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

  void put(int index, Row row) {
    waiting_.emplace(index, std::move(row));
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_; first = waiting_.erase(first)) {
      stream_ << first->second.text;
      if (first->second.opened) ++opened_;
      ++next_;
    }
    stream_.flush();
    if (!stream_) throw IoError("cannot write '" + file_.string() + "'; is the disk full?");
  }

 private:
  int cut_to_complete_rows(const std::string& header) {
    const std::string text = read_text(file_);
    if (text.rfind(header, 0) != 0)
      throw ConfigError(file_.string() + ":1: its columns differ from those of this campaign and version");
    const std::size_t end = text.rfind('\n') + 1;
    std::filesystem::resize_file(file_, end);
    const CsvTable table = read_csv(file_, {{}, {"outcome"}});
    const auto& outcome = table.texts.at("outcome");
    opened_ = static_cast<int>(std::count(outcome.begin(), outcome.end(), "opened"));
    return static_cast<int>(table.rows);
  }

  std::filesystem::path file_;
  std::ofstream stream_;
  std::map<int, Row> waiting_;
  int next_ = 0;
  int opened_ = 0;
};

/// The workers and what they share.
class Pool {
 public:
  Pool(const Campaign& campaign, const RunFunction& run, const CampaignOptions& options, RowFile& rows)
      : campaign_(campaign), run_(run), options_(options), rows_(rows), next_(rows.next()) {}

  void work() {
    int jobs = options_.jobs > 0 ? options_.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    jobs = std::clamp(jobs, 1, std::max(1, campaign_.runs - next_.load()));
    std::vector<std::thread> threads;
    threads.reserve(static_cast<std::size_t>(jobs));
    for (int i = 0; i < jobs; ++i) threads.emplace_back([this] { take_runs(); });
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  [[nodiscard]] bool stopped() const noexcept {
    return failed_.load() || (options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed));
  }

  void take_runs() {
    while (!stopped()) {
      const int index = next_.fetch_add(1);
      if (index >= campaign_.runs) return;
      Row row = make_row(index);
      if (stopped()) return;  // a run that was broken off says nothing
      const std::lock_guard lock(mutex_);
      try {
        rows_.put(index, std::move(row));
        if (options_.progress) options_.progress({rows_.next(), campaign_.runs, rows_.opened()});
      } catch (...) {
        if (!failed_.exchange(true)) failure_ = std::current_exception();
      }
    }
  }

  Row make_row(int index) {
    const std::uint64_t seed = run_seed(campaign_.seed, index);
    CampaignRun made;
    RunResult result;
    int exit_code = 0;
    try {
      made = make_run(campaign_, index);
      result = run_kept(made.scenario, index);
      exit_code = result.exit_code();
    } catch (const Error& error) {
      exit_code = fail(result, error.what(), 2);
    } catch (const std::exception& error) {
      exit_code = fail(result, error.what(), 3);
    }
    if (made.drawn.empty()) made.drawn = empty_drawn();
    return {join_row(index, seed, exit_code, made.drawn, result_fields(result)), exit_code == 0};
  }

  static int fail(RunResult& result, const char* message, int exit_code) {
    result = RunResult{};
    result.outcome = "error";
    result.reason = exit_code == 2 ? "bad_input" : "fault";
    result.explanation = message;
    result.version = version();
    return exit_code;
  }

  [[nodiscard]] std::vector<ResultField> empty_drawn() const {
    std::vector<ResultField> drawn = make_run(campaign_, 0).drawn;
    for (ResultField& field : drawn) field.value = std::monostate{};
    return drawn;
  }

  /// Successful runs leave no folder under `failed`, so they are made without files; a failed one is made again with them.
  /// It gives the same bytes, and writing logs that are thrown away would cost more than the few repetitions.
  RunResult run_kept(const Scenario& scenario, int index) {
    RunOptions options;
    options.stop = options_.stop;
    const std::filesystem::path folder = run_folder(options_.out, index);
    if (options_.keep == Keep::All) options.folder = folder;
    RunResult result = run_(scenario, options);
    if (options_.keep != Keep::Failed || result.exit_code() == 0 || stopped()) return result;
    options.folder = folder;
    return run_(scenario, options);
  }

  const Campaign& campaign_;
  const RunFunction& run_;
  const CampaignOptions& options_;
  RowFile& rows_;
  std::atomic<int> next_;
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::mutex mutex_;
};

}  // namespace

CampaignSummary run_campaign(const Campaign& campaign, const RunFunction& run, const CampaignOptions& options) {
  if (options.out.empty()) throw ConfigError("campaign: an output folder is needed");
  if (options.jobs < 0)
    throw ConfigError(fmt::format("--jobs {}: allowed: at least 1, or 0 for one per processor", options.jobs));
  RowFile rows(campaign, options);
  Pool(campaign, run, options, rows).work();
  const CampaignSummary summary = summarize(rows.file());
  std::ofstream stream(options.out / "summary.json", std::ios::binary);
  stream << to_json(summary);
  stream.close();
  if (!stream) throw IoError("cannot write '" + (options.out / "summary.json").string() + "'");
  write_page(options.out / "report.html", make_campaign_page(options.out));
  return summary;
}

std::filesystem::path run_folder(const std::filesystem::path& out, int index) {
  return out / "runs" / fmt::format("{:05d}", index);
}

RunResult replay_run(const Campaign& campaign, int index, const RunFunction& run, const RunOptions& options) {
  if (index < 0 || index >= campaign.runs) {
    throw ConfigError(fmt::format("{}: run {}: allowed: 0 … {}", campaign.file.string(), index, campaign.runs - 1));
  }
  return run(make_run(campaign, index).scenario, options);
}

}  // namespace ajar
