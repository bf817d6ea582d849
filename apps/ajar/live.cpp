#include "live.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "ajar/core/error.hpp"
#include "ajar/report/report.hpp"
#include "interrupt.hpp"

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::microseconds kPeriod{16667};  ///< 60 Hz: what a screen shows
constexpr std::chrono::milliseconds kLook{5};        ///< The collector looks three times per period
constexpr std::chrono::seconds kSignOfLife{1};       ///< Between two messages to a viewer at most
constexpr std::chrono::seconds kTimeForReport{3};    ///< Given to viewers at the end
constexpr std::size_t kMostRows = 60 * 60 * 10;      ///< Ten minutes at 60 Hz; older rows are not kept
constexpr std::size_t kRowsPerMessage = 600;

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// The address holds the token: only this user may read it.
void write_private(const fs::path& file, const std::string& text) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const bool written = descriptor >= 0 && ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (descriptor >= 0) ::close(descriptor);
  if (!written) throw ajar::IoError("cannot write '" + file.string() + "'");
}

void append_row(const std::vector<float>& row, std::string& text) {
  text += '[';
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) text += ',';
    if (std::isfinite(row[i])) {
      fmt::format_to(std::back_inserter(text), "{:.6g}", row[i]);
    } else {
      text += "null";
    }
  }
  text += ']';
}

}  // namespace

LiveRun::LiveRun(fs::path folder, ajar::JointKind kind, int joints)
    : folder_(std::move(folder)), row_(kind, joints), latest_(row_.names().size()), next_(Clock::now()) {
  history_.reserve(kMostRows);
  server_.on_get("", [this, kind, joints](const std::string&) {
    const ajar::LivePage page{row_.names(), ajar::phase_names(), joints, kind == ajar::JointKind::Slide};
    return Answer{200, "text/html; charset=utf-8", ajar::make_live_page(folder_, page)};
  });
  server_.on_get("report", [this](const std::string&) { return report(); });
  server_.on_events("events", [this](std::size_t& cursor, std::string& text) { return news(cursor, text); });
  server_.on_post("stop", [](const std::string&) {
    request_stop();
    return Answer{200, "text/plain", "stopping\n"};
  });
  server_.start();
  write_private(folder_ / "live.json", nlohmann::json{{"address", server_.address()}}.dump() + "\n");
  collector_ = std::thread([this] { collect(); });
}

LiveRun::~LiveRun() {
  stop_ = true;
  {
    const std::lock_guard lock(history_mutex_);
    ended_ = true;
  }
  arrived_.notify_all();
  collector_.join();
  server_.stop();
  std::error_code ignored;
  fs::remove(folder_ / "live.json", ignored);
}

void LiveRun::offer(const ajar::TickView& tick) noexcept {
  const auto now = Clock::now();
  if (now < next_) return;
  const std::unique_lock lock(latest_mutex_, std::try_to_lock);
  if (!lock) return;
  row_.fill(tick, latest_);
  fresh_ = true;
  next_ = now + kPeriod;
}

void LiveRun::collect() {
  std::vector<float> row(latest_.size());
  while (!stop_) {
    std::this_thread::sleep_for(kLook);
    {
      const std::lock_guard lock(latest_mutex_);
      if (!fresh_) continue;
      fresh_ = false;
      std::transform(latest_.begin(), latest_.end(), row.begin(), [](double v) { return static_cast<float>(v); });
    }
    {
      const std::lock_guard lock(history_mutex_);
      if (history_.size() < kMostRows) history_.push_back(row);
    }
    arrived_.notify_all();
  }
}

bool LiveRun::news(std::size_t& cursor, std::string& text) {
  std::vector<std::vector<float>> rows;
  bool ended = false;
  {
    std::unique_lock lock(history_mutex_);
    arrived_.wait_for(lock, kSignOfLife, [&] { return cursor < history_.size() || ended_; });
    const std::size_t begin = std::min(cursor, history_.size()), end = std::min(history_.size(), begin + kRowsPerMessage);
    rows.assign(history_.begin() + static_cast<std::ptrdiff_t>(begin), history_.begin() + static_cast<std::ptrdiff_t>(end));
    cursor = end;
    ended = ended_ && end == history_.size();
  }
  if (!rows.empty()) {
    text += fmt::format("id: {}\ndata: [", cursor);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i > 0) text += ',';
      append_row(rows[i], text);
    }
    text += "]\n\n";
  }
  if (ended && !stop_) {
    ++waiting_for_report_;
    text += "event: end\ndata: report\n\n";
  }
  return !ended;
}

Answer LiveRun::report() {
  const std::string page = read_text(folder_ / "report.html");
  if (page.empty()) return {404, "text/plain", "ajar: the run has not ended\n"};
  --waiting_for_report_;
  return {200, "text/html; charset=utf-8", page};
}

void LiveRun::finish() {
  {
    const std::lock_guard lock(history_mutex_);
    ended_ = true;
  }
  arrived_.notify_all();
  const auto end = Clock::now() + kTimeForReport;
  while ((server_.viewers() > 0 || waiting_for_report_ > 0) && Clock::now() < end) std::this_thread::sleep_for(kLook);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // the last answer is on its way
}

std::string live_address(const fs::path& folder) {
  const nlohmann::json json = nlohmann::json::parse(read_text(folder / "live.json"), nullptr, false);
  if (!json.is_object() || !json.value("address", nlohmann::json()).is_string()) {
    throw ajar::IoError(folder.string() + ": no run goes on here that was started with --live");
  }
  return json["address"];
}
