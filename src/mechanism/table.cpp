#include "table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

std::vector<std::string> split(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back().push_back(c);
    }
  }
  return cells;
}

}  // namespace

Table::Table(const std::filesystem::path& file) : file_(file.string()) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status)) throw IoError(file_ + ": no such file");
  if (std::filesystem::is_directory(status)) throw IoError(file_ + ": is a directory, a door table is a .csv file");
  std::ifstream in(file);
  if (!in) throw IoError(file_ + ": cannot be read");
  std::string line;
  int number = 0;
  while (std::getline(in, line)) {
    ++number;
    if (line.empty() || line == "\r") continue;
    Row row{number, split(line)};
    if (header_.empty()) {
      header_ = std::move(row.cells);
      continue;
    }
    if (row.cells.size() != header_.size()) {
      fail(number,
           std::to_string(row.cells.size()) + " columns: allowed: " + std::to_string(header_.size()) + " as in the header");
    }
    rows_.push_back(std::move(row));
  }
  if (header_.empty()) fail(1, "empty file: allowed: a header row and one row per door");
  if (rows_.empty()) fail(number, "no rows: allowed: at least one row under the header");
}

std::size_t Table::column(std::string_view name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end()) fail(1, "column " + std::string(name) + " is missing");
  return static_cast<std::size_t>(found - header_.begin());
}

void Table::fail(const Row& row, std::string_view column, const std::string& value, std::string_view rule) const {
  fail(row.line, std::string(column) + ": " + (value.empty() ? "blank" : value) + ": allowed: " + std::string(rule));
}

void Table::fail(int line, const std::string& message) const {
  throw ConfigError(file_ + ":" + std::to_string(line) + ": " + message);
}

double RowReader::number(std::string_view column) const {
  const std::string& cell = text(column);
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    fail(column, "a finite number");
  }
  return value;
}

double RowReader::number_or(std::string_view column, double fallback) const {
  return blank(column) ? fallback : number(column);
}

double RowReader::positive(std::string_view column) const {
  const double value = number(column);
  if (value <= 0.0) fail(column, "> 0");
  return value;
}

double RowReader::not_negative(std::string_view column) const {
  const double value = number(column);
  if (value < 0.0) fail(column, ">= 0");
  return value;
}

Vector3d RowReader::vector(const std::string& prefix) const {
  return {number(prefix + "_x"), number(prefix + "_y"), number(prefix + "_z")};
}

void RowReader::fail(std::string_view column, std::string_view rule) const { table_.fail(row_, column, text(column), rule); }

}  // namespace ajar
