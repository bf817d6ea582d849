#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "ajar/log/channels.hpp"

namespace ajar {

/// What record() does when the disk is slower than the loop.
enum class WhenFull {
  Wait,  ///< Simulation: the loop waits, no row is lost
  Drop   ///< A real robot: the row is dropped and counted
};

struct CsvLogConfig {
  int ring_rows = 1024;  ///< Rows held between loop and disk; about 1 kB each [-], 2 … 1 000 000
  WhenFull when_full = WhenFull::Wait;
  /// @throws ConfigError
  void validate() const;
};

/// One row per tick on its way to a CSV file: the loop copies into a ring buffer, a thread formats and writes.
/// Memory is bounded by the ring. Every recorded row is on disk after close() or destruction.
class CsvLog {
 public:
  /// Creates the file and writes the header row.
  /// @throws ConfigError, IoError
  CsvLog(const std::filesystem::path& file, const ChannelList& channels, const CsvLogConfig& config = {});
  /// Writes what is left; errors are lost here, call close() to hear of them.
  ~CsvLog();
  CsvLog(const CsvLog&) = delete;
  CsvLog& operator=(const CsvLog&) = delete;

  /// Hands over one row, made for the same channels. One thread only. No allocation, no exception.
  void record(const LogRow& row) noexcept;

  /// Writes what is left and closes the file; further rows are ignored. @throws IoError  if any write failed
  void close();

  [[nodiscard]] std::uint64_t rows() const noexcept;     ///< Rows taken by record() [-]
  [[nodiscard]] std::uint64_t dropped() const noexcept;  ///< Rows lost because the ring was full [-]

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A number as every file of ours writes it: nine significant digits, the shortest form of them.
/// Nine digits keep 1e-9 m at room size and make the bytes independent of the locale.
[[nodiscard]] std::string format_number(double value);

}  // namespace ajar
