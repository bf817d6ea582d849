#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace ajar::bench {

/// Something that is measured step by step. What `prepare` does is not timed.
class Case {
 public:
  virtual ~Case() = default;
  virtual void prepare() {}
  virtual void step() = 0;
};

struct CaseInfo {
  std::string name;
  std::string problem;  ///< What is solved, in a few words
  int steps = 10000;
  std::function<std::unique_ptr<Case>()> make;
};

[[nodiscard]] std::vector<CaseInfo> all_cases();

/// Collects every measured case and prints one table, or one JSON list, at the end.
class TableReporter : public benchmark::BenchmarkReporter {
 public:
  explicit TableReporter(bool json) : json_(json) {}
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override;

 private:
  struct Row {
    std::string name;
    std::string problem;
    double median;
    double p99;
    double p999;
    double allocations;
  };
  bool json_;
  std::vector<Row> rows_;
};

}  // namespace ajar::bench
