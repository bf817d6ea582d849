#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ajar {

/// Splits one line of a CSV file; cells in double quotes may hold commas and doubled quotes.
[[nodiscard]] std::vector<std::string> split_csv_line(std::string_view line);

/// A cell as CSV: quoted when it must be; line breaks become spaces so that a row is always one line.
[[nodiscard]] std::string csv_cell(std::string_view text);

/// Chosen columns of a CSV file, complete rows only.
struct CsvTable {
  std::size_t rows = 0;
  std::vector<std::string> names;                         ///< All columns of the file, in order
  std::map<std::string, std::vector<double>> numbers;     ///< Wanted number columns that exist; NaN where not a number
  std::map<std::string, std::vector<std::string>> texts;  ///< Wanted text columns that exist
  bool cut_off = false;                                   ///< The last line was incomplete and left out
};

/// Which columns to read; those that the file does not have are left out of the table.
struct CsvColumns {
  std::vector<std::string> numbers;
  std::vector<std::string> texts;
};

/// Reads the wanted columns. An incomplete last line (a run that was killed) is left out.
/// @throws IoError  if the file cannot be read, is empty, or a row in the middle has the wrong number of cells
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& file, const CsvColumns& wanted);

}  // namespace ajar
