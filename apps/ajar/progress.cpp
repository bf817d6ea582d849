#include "progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kBarWidth = 24;
constexpr double kDegree = std::numbers::pi / 180.0;

bool is_terminal() { return isatty(fileno(stderr)) == 1; }

std::string bar(double share) {
  const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * kBarWidth));
  return fmt::format("[{:#<{}}{:.<{}}]", "", full, "", kBarWidth - full);
}

void end_line(bool& open_line) {
  if (open_line) fmt::print(stderr, "\n");
  open_line = false;
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// "42 s", "3 min 05 s", "1 h 20 min": as exact as a guess deserves.
std::string duration_words(double seconds) {
  const auto s = static_cast<std::int64_t>(std::lround(std::max(0.0, seconds)));
  if (s < 100) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

std::string type_name(ajar::MechanismType type) {
  switch (type) {
    case ajar::MechanismType::Hinge: return "hinge";
    case ajar::MechanismType::Slide: return "slide";
    case ajar::MechanismType::Unknown: break;
  }
  return "unknown";
}

}  // namespace

RunTicker::RunTicker(ajar::JointKind kind) : kind_(kind), terminal_(is_terminal()) {}

std::string RunTicker::line(const ajar::RunProgress& p) const {
  std::string text = fmt::format("{:6.1f} s  {:<9}", p.time, ajar::to_string(p.phase));
  const double wall = seconds_since(start_);
  if (wall > 0.0 && p.time > 0.0) {
    // What is left of the time limit, at the pace so far: the longest that one has to wait.
    const double left = std::max(0.0, p.time_limit - p.time) * wall / p.time;
    text += fmt::format("{:5.1f}x  at most {} left", p.time / wall, duration_words(left));
  }
  if (p.phase != ajar::Phase::Probe && p.phase != ajar::Phase::Open && p.phase != ajar::Phase::Release) return text;
  text += kind_ == ajar::JointKind::Hinge ? fmt::format(" opening {:5.1f}°", p.opening / kDegree)
                                          : fmt::format(" opening {:.3f} m", p.opening);
  text += fmt::format("  force {:4.0f} N", p.force);
  if (p.record != nullptr) {
    const ajar::MechanismEstimate& e = p.record->estimate;
    const double curvature = e.curvature.norm();
    text += fmt::format("  believes {}", type_name(e.type));
    if (e.type != ajar::MechanismType::Slide && curvature > 0.1) text += fmt::format(", r {:.2f} m", 1.0 / curvature);
    text += fmt::format(", direction ±{:.1f}°", std::min(e.direction_sigma / kDegree, 90.0));
  }
  return text;
}

void RunTicker::tell(const ajar::RunProgress& p) {
  const bool new_phase = !started_ || p.phase != phase_;
  started_ = true;
  phase_ = p.phase;
  if (terminal_) {
    if (new_phase) end_line(open_line_);
    fmt::print(stderr, "\r{}\x1b[K", line(p));
    std::fflush(stderr);
    open_line_ = true;
  } else if (new_phase || p.time >= next_) {
    fmt::print(stderr, "{}\n", line(p));
    next_ = p.time + 2.0;
  }
}

void RunTicker::finish() { end_line(open_line_); }

CampaignTicker::CampaignTicker() : terminal_(is_terminal()) {}

void CampaignTicker::tell(const ajar::CampaignProgress& p) {
  const double share = p.runs > 0 ? static_cast<double>(p.done) / p.runs : 1.0;
  if (first_ < 0) first_ = p.done - 1;  // a campaign that is resumed has rows already
  std::string text = fmt::format("{} of {} runs, {} opened", p.done, p.runs, p.opened);
  const int made = p.done - first_;
  if (made > 0) text += fmt::format(", {} left", duration_words(seconds_since(start_) / made * (p.runs - p.done)));
  if (terminal_) {
    fmt::print(stderr, "\r{} {}\x1b[K", bar(share), text);
    std::fflush(stderr);
    open_line_ = true;
    return;
  }
  const int tenth = static_cast<int>(share * 10.0);
  if (tenth != last_tenth_) fmt::print(stderr, "{}\n", text);
  last_tenth_ = tenth;
}

void CampaignTicker::finish() { end_line(open_line_); }
