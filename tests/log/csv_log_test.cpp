// Strategy: write rows through the log and read the file back as bytes: completeness (every row after close, after
// destruction and while an exception unwinds), lossless order through a ring much smaller than the run, the same bytes
// twice, no allocation on the loop's side (global operator new counts per thread). Left out: power loss.
#include "ajar/log/csv_log.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <new>
#include <sstream>
#include <stdexcept>

#include "ajar/core/error.hpp"
#include "ajar/log/csv_table.hpp"

namespace {
thread_local long allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace ajar {
namespace {

std::filesystem::path temp_file(const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() / "ajar_log_test";
  std::filesystem::create_directories(folder);
  return folder / (name + std::to_string(::getpid()) + ".csv");
}

std::string read_all(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Columns {
  ChannelList list;
  NumberChannel x = list.number("x", "m");
  IntegerChannel n = list.integer("n", "");
  TextChannel word = list.text("word");
};

void write_rows(CsvLog& log, const Columns& columns, int count) {
  LogRow row(columns.list);
  for (int i = 0; i < count; ++i) {
    row.set(columns.x, 0.1 * i);
    row.set(columns.n, i);
    row.set(columns.word, i % 2 == 0 ? "even" : "odd");
    log.record(row);
  }
}

TEST(CsvLog, WritesHeaderAndNineDigits) {
  const Columns columns;
  const auto file = temp_file("digits");
  CsvLog log(file, columns.list);
  LogRow row(columns.list);
  row.set(columns.x, 1.0 / 3.0);
  row.set(columns.n, -7);
  row.set(columns.word, "a,\"b\"");
  log.record(row);
  row.set(columns.x, std::numeric_limits<double>::quiet_NaN());
  row.set(columns.word, nullptr);
  log.record(row);
  log.close();
  EXPECT_EQ(read_all(file), "x,n,word\n0.333333333,-7,\"a,\"\"b\"\"\"\nnan,-7,\n");
}

TEST(CsvLog, IsCompleteAfterDestructionThroughATinyRing) {
  const Columns columns;
  const auto file = temp_file("tiny");
  {
    CsvLogConfig config;
    config.ring_rows = 8;
    CsvLog log(file, columns.list, config);
    write_rows(log, columns, 2000);
    EXPECT_EQ(log.dropped(), 0u);
  }
  const CsvTable table = read_csv(file, {{"n"}, {"word"}});
  ASSERT_EQ(table.rows, 2000u);
  for (std::size_t i = 0; i < table.rows; ++i) {
    ASSERT_EQ(table.numbers.at("n")[i], static_cast<double>(i));
    ASSERT_EQ(table.texts.at("word")[i], i % 2 == 0 ? "even" : "odd");
  }
}

TEST(CsvLog, IsCompleteWhenAnExceptionUnwindsTheLoop) {
  const Columns columns;
  const auto file = temp_file("unwind");
  try {
    CsvLog log(file, columns.list);
    write_rows(log, columns, 321);
    throw std::runtime_error("loop failed");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(read_csv(file, {}).rows, 321u);
}

TEST(CsvLog, SameRowsGiveSameBytes) {
  const Columns columns;
  for (const char* name : {"one", "two"}) {
    CsvLog log(temp_file(name), columns.list);
    write_rows(log, columns, 500);
  }
  EXPECT_EQ(read_all(temp_file("one")), read_all(temp_file("two")));
}

TEST(CsvLog, RecordDoesNotAllocate) {
  const Columns columns;
  CsvLogConfig config;
  config.ring_rows = 16;
  CsvLog log(temp_file("alloc"), columns.list, config);
  LogRow row(columns.list);
  const long before = allocations;
  for (int i = 0; i < 1000; ++i) {
    row.set(columns.x, i);
    log.record(row);
  }
  EXPECT_EQ(allocations - before, 0);
}

TEST(CsvLog, DropsAndCountsWhenAskedTo) {
  const Columns columns;
  const auto file = temp_file("drop");
  CsvLogConfig config;
  config.ring_rows = 2;
  config.when_full = WhenFull::Drop;
  CsvLog log(file, columns.list, config);
  write_rows(log, columns, 5000);
  log.close();
  EXPECT_GT(log.dropped(), 0u);
  EXPECT_EQ(log.rows() + log.dropped(), 5000u);
  EXPECT_EQ(read_csv(file, {}).rows, log.rows());
}

TEST(CsvLog, IgnoresRowsAfterCloseAndRowsOfOtherChannels) {
  const Columns columns;
  const auto file = temp_file("after");
  CsvLog log(file, columns.list);
  ChannelList other;
  (void)other.number("y", "m");
  log.record(LogRow(other));
  log.close();
  log.close();
  write_rows(log, columns, 3);
  EXPECT_EQ(read_csv(file, {}).rows, 0u);
}

TEST(CsvLog, RefusesWhatCannotBeWritten) {
  const Columns columns;
  EXPECT_THROW(CsvLog("/nowhere/at/all/log.csv", columns.list), IoError);
  EXPECT_THROW(CsvLog(temp_file("none"), ChannelList{}), ConfigError);
  CsvLogConfig config;
  config.ring_rows = 1;
  EXPECT_THROW(CsvLog(temp_file("ring"), columns.list, config), ConfigError);
  if (std::filesystem::exists("/dev/full")) {
    CsvLog full("/dev/full", columns.list);
    write_rows(full, columns, 10);
    EXPECT_THROW(full.close(), IoError);
  }
}

TEST(ChannelList, RefusesTakenAndUnusableNames) {
  ChannelList list;
  (void)list.number("a", "m");
  EXPECT_THROW((void)list.text("a"), ConfigError);
  EXPECT_THROW((void)list.text(""), ConfigError);
  EXPECT_THROW((void)list.number("a,b", ""), ConfigError);
}

}  // namespace
}  // namespace ajar
