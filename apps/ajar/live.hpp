#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "ajar/campaign/live_row.hpp"
#include "local_server.hpp"

/// A run for viewers while it goes on. The loop leaves a row when a sixtieth of a second has passed and nobody reads at that
/// instant; it never waits. What viewers get, and how slowly they take it, happens on other threads.
class LiveRun {
 public:
  /// @param folder  Run folder: scene and report are read from it, `live.json` tells the address while the run goes on
  /// @throws ajar::IoError
  LiveRun(std::filesystem::path folder, ajar::JointKind kind, int joints);
  ~LiveRun();
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  [[nodiscard]] const std::string& address() const noexcept { return server_.address(); }

  /// Takes one tick. Loop only. No allocation, never waits.
  void offer(const ajar::TickView& tick) noexcept;

  /// The run has ended and its report is written: viewers are told, and get up to three seconds to fetch it.
  void finish();

 private:
  void collect();
  bool news(std::size_t& cursor, std::string& text);
  [[nodiscard]] Answer report();

  std::filesystem::path folder_;
  ajar::LiveRow row_;

  // Between the loop and the collector.
  std::mutex latest_mutex_;
  std::vector<double> latest_;
  bool fresh_ = false;
  std::chrono::steady_clock::time_point next_;

  // Between the collector and the viewers.
  std::mutex history_mutex_;
  std::condition_variable arrived_;
  std::vector<std::vector<float>> history_;
  bool ended_ = false;
  std::atomic<int> waiting_for_report_{0};

  std::atomic<bool> stop_{false};
  std::thread collector_;
  LocalServer server_;
};

/// Address of the run that goes on in a folder. @throws ajar::IoError  if none does
[[nodiscard]] std::string live_address(const std::filesystem::path& folder);
