#include "ajar/log/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

double parse_number(std::string_view cell) {
  double value = kNotANumber;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size() ? value : kNotANumber;
}

/// Where the cells of one kind go: column number in the file and the vector that takes it.
template <typename Value>
struct Target {
  std::size_t column;
  std::vector<Value>* values;
};

template <typename Value>
std::vector<Target<Value>> find_targets(const std::vector<std::string>& names, const std::vector<std::string>& wanted,
                                        std::map<std::string, std::vector<Value>>& out) {
  std::vector<Target<Value>> targets;
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) continue;
    targets.push_back({static_cast<std::size_t>(found - names.begin()), &out[name]});
  }
  return targets;
}

/// Views of the cells of a line; quoted cells only where the line has quotes.
void split(const std::string& line, std::vector<std::string_view>& views, std::vector<std::string>& owned) {
  views.clear();
  if (line.find('"') != std::string::npos) {
    owned = split_csv_line(line);
    views.assign(owned.begin(), owned.end());
    return;
  }
  const std::string_view text = line;
  std::size_t begin = 0;
  for (std::size_t comma = text.find(','); comma != std::string_view::npos; comma = text.find(',', begin)) {
    views.push_back(text.substr(begin, comma - begin));
    begin = comma + 1;
  }
  views.push_back(text.substr(begin));
}

}  // namespace

std::vector<std::string> split_csv_line(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back().push_back('"');
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back().push_back(c);
    }
  }
  return cells;
}

std::string csv_cell(std::string_view text) {
  std::string clean(text);
  std::replace_if(clean.begin(), clean.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  if (clean.find_first_of(",\"") == std::string::npos) return clean;
  std::string quoted = "\"";
  for (const char c : clean) {
    if (c == '"') quoted.push_back('"');
    quoted.push_back(c);
  }
  quoted.push_back('"');
  return quoted;
}

CsvTable read_csv(const std::filesystem::path& file, const CsvColumns& wanted) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw IoError("cannot read '" + file.string() + "'; a CSV file is needed");
  std::string line;
  if (!std::getline(stream, line) || line.empty() || stream.eof()) {
    throw IoError("'" + file.string() + "' is empty; line 1 must be a complete header row");
  }
  CsvTable table;
  table.names = split_csv_line(line);
  const auto numbers = find_targets<double>(table.names, wanted.numbers, table.numbers);
  const auto texts = find_targets<std::string>(table.names, wanted.texts, table.texts);
  std::vector<std::string_view> cells;
  std::vector<std::string> owned;
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    if (stream.eof()) {  // no line break at its end: the writer was cut off here
      table.cut_off = true;
      break;
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    split(line, cells, owned);
    if (cells.size() != table.names.size()) {
      throw IoError(file.string() + ":" + std::to_string(number) + ": " + std::to_string(cells.size()) +
                    " cells; the header has " + std::to_string(table.names.size()));
    }
    for (const auto& target : numbers) target.values->push_back(parse_number(cells[target.column]));
    for (const auto& target : texts) target.values->emplace_back(cells[target.column]);
    ++table.rows;
  }
  return table;
}

}  // namespace ajar
