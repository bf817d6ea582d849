#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ajar {

/// Column of real numbers.
struct NumberChannel {
  std::size_t index = 0;
};
/// Column of whole numbers.
struct IntegerChannel {
  std::size_t index = 0;
};
/// Column of words from a closed set; the strings must live as long as the log (literals).
struct TextChannel {
  std::size_t index = 0;
};

enum class ChannelKind { Number, Integer, Text };

/// What one column of a log is.
struct ChannelInfo {
  std::string name;
  std::string unit;  ///< SI symbol, empty for words and pure numbers
  ChannelKind kind = ChannelKind::Number;
};

/// The columns of a log, registered once at set-up in the order of the file.
class ChannelList {
 public:
  /// @throws ConfigError  if the name is empty, taken, or holds a comma, quote or line break
  NumberChannel number(const std::string& name, const std::string& unit);
  IntegerChannel integer(const std::string& name, const std::string& unit);
  TextChannel text(const std::string& name);

  [[nodiscard]] const std::vector<ChannelInfo>& infos() const noexcept { return infos_; }
  [[nodiscard]] std::size_t size() const noexcept { return infos_.size(); }

 private:
  std::size_t add(const std::string& name, const std::string& unit, ChannelKind kind);
  std::vector<ChannelInfo> infos_;
};

/// The values of one tick; made once, filled again and again without allocation.
class LogRow {
 public:
  /// One cell; which member counts is known by its column.
  union Cell {
    double number;
    std::int64_t integer;
    const char* text;
  };

  explicit LogRow(const ChannelList& channels);

  void set(NumberChannel channel, double value) noexcept { cells_[channel.index].number = value; }
  void set(IntegerChannel channel, std::int64_t value) noexcept { cells_[channel.index].integer = value; }
  /// @param value  A string that outlives the log; nullptr leaves the cell empty
  void set(TextChannel channel, const char* value) noexcept { cells_[channel.index].text = value; }

  [[nodiscard]] const std::vector<Cell>& cells() const noexcept { return cells_; }

 private:
  std::vector<Cell> cells_;
};

}  // namespace ajar
