#include "ajar/estimation/track.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

// What a column can hold; each of the names, as people and Ajar's own logs call it.
enum Field { Time, X, Y, Z, Qx, Qy, Qz, Qw, Fx, Fy, Fz, Fields };
constexpr std::array<std::array<std::string_view, 2>, Fields> kNames{{{"time", "t"},
                                                                      {"x", "hand_x"},
                                                                      {"y", "hand_y"},
                                                                      {"z", "hand_z"},
                                                                      {"qx", "hand_qx"},
                                                                      {"qy", "hand_qy"},
                                                                      {"qz", "hand_qz"},
                                                                      {"qw", "hand_qw"},
                                                                      {"fx", "force_x"},
                                                                      {"fy", "force_y"},
                                                                      {"fz", "force_z"}}};
constexpr double kUnitTolerance = 0.02;  // of a quaternion written with two or more digits [-]

struct Layout {
  std::array<int, Fields> column{};  // -1: not there
  int phase = -1;                    // column of the phase in a run's log
  std::size_t columns = 0;
  [[nodiscard]] bool has(Field field) const { return column[field] >= 0; }
};

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), file_(path) {
    if (!file_) throw IoError(path + ": cannot be read");
  }

  Track read() {
    std::string line;
    while (std::getline(file_, line)) {
      ++number_;
      split(line);
      if (words_.empty() || words_[0].front() == '#') continue;
      if (layout_.columns == 0 && !is_number(words_[0])) {
        read_header();
        continue;
      }
      if (layout_.columns == 0) guess_layout();
      if (words_.size() != layout_.columns) {
        fail(std::to_string(words_.size()) + " columns, the lines before have " + std::to_string(layout_.columns));
      }
      add_sample();
    }
    if (file_.bad()) throw IoError(path_ + ": cannot be read to its end");
    if (track_.samples.empty()) throw ConfigError(path_ + ": holds no samples");
    return std::move(track_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ConfigError(path_ + ":" + std::to_string(number_) + ": " + what);
  }

  static bool is_number(const std::string& word) {
    char* end = nullptr;
    (void)std::strtod(word.c_str(), &end);
    return *end == '\0';
  }

  void split(const std::string& line) {
    words_.clear();
    std::size_t begin = 0;
    const std::string_view separators = ",; \t\r";
    while ((begin = line.find_first_not_of(separators, begin)) != std::string::npos) {
      const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
      words_.push_back(line.substr(begin, end - begin));
      begin = end;
    }
  }

  void set_layout(Layout layout) {
    track_.has_time = layout.has(Time);
    track_.has_rotation = layout.has(Qx);
    track_.has_force = layout.has(Fx);
    layout_ = layout;
  }

  void read_header() {
    Layout layout;
    layout.column.fill(-1);
    layout.columns = words_.size();
    for (std::size_t i = 0; i < words_.size(); ++i) {
      if (words_[i] == "phase") layout.phase = static_cast<int>(i);
      for (std::size_t f = 0; f < Fields; ++f) {
        if (words_[i] == kNames[f][0] || words_[i] == kNames[f][1]) layout.column[f] = static_cast<int>(i);
      }
    }
    require_all(layout, X, 3, true);
    require_all(layout, Qx, 4, false);
    require_all(layout, Fx, 3, false);
    set_layout(layout);
  }

  // A group of columns is there as a whole or not at all.
  void require_all(const Layout& layout, std::size_t first, std::size_t count, bool needed) const {
    std::size_t found = 0;
    std::string missing;
    for (std::size_t f = first; f < first + count; ++f) {
      if (layout.column[f] >= 0) {
        ++found;
      } else {
        missing.append(" ").append(kNames[f][0]);
      }
    }
    if (found < count && (needed || found > 0)) fail("the header lacks" + missing);
  }

  void guess_layout() {
    const std::size_t n = words_.size();
    const auto value = [this](std::size_t i) { return std::strtod(words_[i].c_str(), nullptr); };
    const auto unit = [&value](std::size_t i) {
      return std::abs(std::hypot(std::hypot(value(i), value(i + 1)), std::hypot(value(i + 2), value(i + 3))) - 1.0) <
             kUnitTolerance;
    };
    const bool quaternion = n == 8 || n == 10 || n == 11 || (n == 7 && unit(3));
    const bool force = n == 6 || n == 10 || n == 11 || (n == 7 && !quaternion);
    const bool time = n == 4 || n == 8 || n == 11 || (n == 7 && !quaternion);
    if (n != 3 && n != 4 && !quaternion && !force) {
      fail(std::to_string(n) +
           " columns; allowed: 3 (x y z), 4 (time x y z), 6 (x y z fx fy fz), 7 (x y z qx qy qz qw), 8 (time and pose), 10 "
           "(pose and force), 11 (time, pose, force), or a header that names them");
    }
    Layout layout;
    layout.column.fill(-1);
    layout.columns = n;
    int next = 0;
    if (time) layout.column[Time] = next++;
    for (std::size_t f = X; f <= Z; ++f) layout.column[f] = next++;
    for (std::size_t f = Qx; quaternion && f <= Qw; ++f) layout.column[f] = next++;
    for (std::size_t f = Fx; force && f <= Fz; ++f) layout.column[f] = next++;
    set_layout(layout);
  }

  [[nodiscard]] double number(std::size_t field) const {
    const std::string& word = words_[static_cast<std::size_t>(layout_.column[field])];
    const std::string name(kNames[field][0]);
    if (!is_number(word)) fail(name + " = '" + word + "': must be a number");
    const double value = std::strtod(word.c_str(), nullptr);
    if (!std::isfinite(value)) fail(name + " = " + word + ": must be finite");
    return value;
  }

  void add_sample() {
    if (layout_.phase >= 0 && words_[static_cast<std::size_t>(layout_.phase)] != "open") return;
    TrackSample sample;
    sample.position = Vector3d(number(X), number(Y), number(Z));
    if (track_.has_force) sample.force = Vector3d(number(Fx), number(Fy), number(Fz));
    if (track_.has_rotation) {
      const Eigen::Quaterniond q(number(Qw), number(Qx), number(Qy), number(Qz));
      if (std::abs(q.norm() - 1.0) > kUnitTolerance) {
        fail("quaternion of length " + std::to_string(q.norm()) + ": must be 1");
      }
      sample.rotation = q.normalized().toRotationMatrix();
    }
    if (track_.has_time) {
      sample.time = number(Time);
      if (!track_.samples.empty() && sample.time < track_.samples.back().time) {
        fail("time = " + words_[static_cast<std::size_t>(layout_.column[Time])] + ": goes back");
      }
    }
    track_.samples.push_back(sample);
  }

  std::string path_;
  std::ifstream file_;
  int number_ = 0;
  std::vector<std::string> words_;
  Layout layout_;  // no columns: not read yet
  Track track_;
};

}  // namespace

Track load_track(const std::string& path) { return Reader(path).read(); }

}  // namespace ajar
