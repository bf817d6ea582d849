#include "ajar/log/csv_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>

#include "ajar/core/error.hpp"
#include "ajar/log/csv_table.hpp"

namespace ajar {
namespace {

/// Bytes gathered before they go to the file; one page of output is cheap and keeps memory small.
constexpr std::size_t kChunkBytes = 1 << 16;
/// Pause of either side when it has nothing to do. 1 ms of a 500 Hz loop at 200 × real time is 100 rows, far below the ring.
constexpr std::chrono::microseconds kPause{1000};

void append_cell(fmt::memory_buffer& out, const LogRow::Cell& cell, ChannelKind kind) {
  switch (kind) {
    case ChannelKind::Number: fmt::format_to(std::back_inserter(out), "{:.9g}", cell.number); break;
    case ChannelKind::Integer: fmt::format_to(std::back_inserter(out), "{}", cell.integer); break;
    case ChannelKind::Text:
      if (cell.text != nullptr) {
        const std::string_view text = cell.text;
        if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
          out.append(text.data(), text.data() + text.size());
        } else {
          const std::string quoted = csv_cell(text);
          out.append(quoted.data(), quoted.data() + quoted.size());
        }
      }
      break;
  }
}

}  // namespace

std::string format_number(double value) { return fmt::format("{:.9g}", value); }

void CsvLogConfig::validate() const {
  if (ring_rows < 2 || ring_rows > 1000000) {
    throw ConfigError(fmt::format("log.ring_rows = {} is out of range; allowed: 2 to 1000000", ring_rows));
  }
}

/// A single-producer single-consumer ring of rows: `head` counts rows put in, `tail` rows taken out.
struct CsvLog::Impl {
  std::filesystem::path file;
  std::vector<ChannelInfo> infos;
  CsvLogConfig config;
  std::vector<LogRow::Cell> ring;
  std::size_t columns = 0;
  alignas(64) std::atomic<std::uint64_t> head{0};
  alignas(64) std::atomic<std::uint64_t> tail{0};
  std::atomic<std::uint64_t> dropped{0};
  std::atomic<bool> closing{false};
  std::atomic<bool> failed{false};
  std::FILE* stream = nullptr;
  fmt::memory_buffer buffer;
  std::thread writer;

  void flush_buffer() {
    if (buffer.size() == 0) return;
    if (std::fwrite(buffer.data(), 1, buffer.size(), stream) != buffer.size()) failed = true;
    buffer.clear();
  }

  void write_header() {
    for (std::size_t i = 0; i < infos.size(); ++i) {
      if (i > 0) buffer.push_back(',');
      buffer.append(infos[i].name.data(), infos[i].name.data() + infos[i].name.size());
    }
    buffer.push_back('\n');
    flush_buffer();
  }

  void write_row(std::uint64_t number) {
    const LogRow::Cell* cells =
        &ring[static_cast<std::size_t>(number % static_cast<std::uint64_t>(config.ring_rows)) * columns];
    for (std::size_t i = 0; i < columns; ++i) {
      if (i > 0) buffer.push_back(',');
      append_cell(buffer, cells[i], infos[i].kind);
    }
    buffer.push_back('\n');
    if (buffer.size() >= kChunkBytes) flush_buffer();
  }

  void write_loop() {
    while (true) {
      const bool last_round = closing.load(std::memory_order_acquire);
      const std::uint64_t available = head.load(std::memory_order_acquire);
      std::uint64_t number = tail.load(std::memory_order_relaxed);
      for (; number < available; ++number) {
        write_row(number);
        tail.store(number + 1, std::memory_order_release);
      }
      if (last_round) break;
      std::this_thread::sleep_for(kPause);
    }
    flush_buffer();
  }
};

CsvLog::CsvLog(const std::filesystem::path& file, const ChannelList& channels, const CsvLogConfig& config)
    : impl_(std::make_unique<Impl>()) {
  config.validate();
  if (channels.size() == 0) throw ConfigError("log: no channels; at least one is needed");
  impl_->file = file;
  impl_->infos = channels.infos();
  impl_->config = config;
  impl_->columns = channels.size();
  impl_->ring.resize(static_cast<std::size_t>(config.ring_rows) * channels.size());
  impl_->stream = std::fopen(file.c_str(), "wb");
  if (impl_->stream == nullptr) throw IoError("cannot write '" + file.string() + "'; a writable folder is needed");
  impl_->write_header();
  impl_->writer = std::thread([impl = impl_.get()] { impl->write_loop(); });
}

CsvLog::~CsvLog() {
  try {
    close();
  } catch (const IoError&) {
    // A destructor has nobody to tell; close() is the way to hear of it.
  }
}

void CsvLog::record(const LogRow& row) noexcept {
  if (impl_->stream == nullptr || row.cells().size() != impl_->columns) return;
  const auto capacity = static_cast<std::uint64_t>(impl_->config.ring_rows);
  const std::uint64_t number = impl_->head.load(std::memory_order_relaxed);
  while (number - impl_->tail.load(std::memory_order_acquire) >= capacity) {
    if (impl_->config.when_full == WhenFull::Drop) {
      impl_->dropped.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    std::this_thread::sleep_for(kPause);
  }
  const auto slot = static_cast<std::size_t>(number % capacity) * impl_->columns;
  std::copy(row.cells().begin(), row.cells().end(), impl_->ring.begin() + static_cast<std::ptrdiff_t>(slot));
  impl_->head.store(number + 1, std::memory_order_release);
}

void CsvLog::close() {
  if (impl_->stream == nullptr) return;
  impl_->closing.store(true, std::memory_order_release);
  impl_->writer.join();
  if (std::fclose(impl_->stream) != 0) impl_->failed = true;
  impl_->stream = nullptr;
  if (impl_->failed) throw IoError("cannot write all of '" + impl_->file.string() + "'; is the disk full?");
}

std::uint64_t CsvLog::rows() const noexcept { return impl_->head.load(std::memory_order_relaxed); }
std::uint64_t CsvLog::dropped() const noexcept { return impl_->dropped.load(std::memory_order_relaxed); }

}  // namespace ajar
