// Strategy: small files with known content: quoting round trip, wanted columns only, a cut-off last line, broken rows.
#include "ajar/log/csv_table.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

std::filesystem::path write_file(const std::string& text) {
  const auto file = std::filesystem::temp_directory_path() / ("ajar_csv_table_" + std::to_string(::getpid()) + ".csv");
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

TEST(CsvCell, ComesBackFromQuotingAndStaysOnOneLine) {
  for (const std::string text : {"plain", "a,b", "say \"no\"", "", "\"", ",,"}) {
    EXPECT_EQ(split_csv_line(csv_cell(text) + ",end"), (std::vector<std::string>{text, "end"})) << text;
  }
  EXPECT_EQ(csv_cell("two\nlines"), "two lines");
}

TEST(ReadCsv, GivesWantedColumnsAndNaNForWords) {
  const CsvTable table = read_csv(write_file("a,b,c\n1,x,3\n-2.5e3,y,\n"), {{"a", "c", "missing"}, {"b"}});
  EXPECT_EQ(table.rows, 2u);
  EXPECT_EQ(table.names, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(table.numbers.at("a"), (std::vector<double>{1.0, -2500.0}));
  EXPECT_TRUE(std::isnan(table.numbers.at("c")[1]));
  EXPECT_EQ(table.texts.at("b"), (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(table.numbers.count("missing"), 0u);
  EXPECT_FALSE(table.cut_off);
}

TEST(ReadCsv, LeavesOutAnIncompleteLastLine) {
  const CsvTable table = read_csv(write_file("a,b\n1,2\n3,4\n5,"), {{"a"}, {}});
  EXPECT_EQ(table.rows, 2u);
  EXPECT_TRUE(table.cut_off);
  // A line that looks complete but has no line break may have lost digits: it is left out as well.
  EXPECT_EQ(read_csv(write_file("a,b\n1,2\n3,4"), {{"a"}, {}}).rows, 1u);
}

TEST(ReadCsv, NamesTheLineOfABrokenRow) {
  try {
    (void)read_csv(write_file("a,b\n1,2\n3\n4,5\n"), {{"a"}, {}});
    FAIL() << "no error";
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find(":3: 1 cells; the header has 2"), std::string::npos) << error.what();
  }
}

TEST(ReadCsv, RefusesMissingEmptyAndFolder) {
  EXPECT_THROW((void)read_csv("/nowhere.csv", {}), IoError);
  EXPECT_THROW((void)read_csv(write_file(""), {}), IoError);
  EXPECT_THROW((void)read_csv(write_file("a,b"), {}), IoError);
  EXPECT_THROW((void)read_csv(std::filesystem::temp_directory_path(), {}), IoError);
}

}  // namespace
}  // namespace ajar
