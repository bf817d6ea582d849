#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

/// A comma-separated table with a header row; keeps file and line for messages.
class Table {
 public:
  /// @throws IoError when it cannot be read, ConfigError when it is empty or a row has another number of columns
  explicit Table(const std::filesystem::path& file);

  struct Row {
    int line = 0;
    std::vector<std::string> cells;
  };
  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }
  /// @throws ConfigError when the table has no such column
  [[nodiscard]] std::size_t column(std::string_view name) const;
  /// @throws ConfigError "file:line: column: value: allowed: rule"
  [[noreturn]] void fail(const Row& row, std::string_view column, const std::string& value, std::string_view rule) const;
  [[noreturn]] void fail(int line, const std::string& message) const;

 private:
  std::string file_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

/// One row of a table with typed access by column name. Every failure is a ConfigError with file, line, column and value.
class RowReader {
 public:
  RowReader(const Table& table, const Table::Row& row) : table_(table), row_(row) {}

  [[nodiscard]] const std::string& text(std::string_view column) const { return row_.cells[table_.column(column)]; }
  [[nodiscard]] bool blank(std::string_view column) const { return text(column).empty(); }
  [[nodiscard]] double number(std::string_view column) const;
  [[nodiscard]] double number_or(std::string_view column, double fallback) const;
  [[nodiscard]] double positive(std::string_view column) const;
  [[nodiscard]] double not_negative(std::string_view column) const;
  /// Columns PREFIX_x, PREFIX_y, PREFIX_z.
  [[nodiscard]] Vector3d vector(const std::string& prefix) const;
  [[noreturn]] void fail(std::string_view column, std::string_view rule) const;

 private:
  const Table& table_;
  const Table::Row& row_;
};

}  // namespace ajar
