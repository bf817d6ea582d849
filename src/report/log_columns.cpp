#include "log_columns.hpp"

#include <limits>

namespace ajar {

LogColumns::LogColumns(CsvTable table)
    : table_(std::move(table)), empty_(table_.rows, std::numeric_limits<double>::quiet_NaN()) {}

const LogColumns::Column& LogColumns::operator[](const std::string& name) const {
  const auto found = table_.numbers.find(name);
  return found == table_.numbers.end() ? empty_ : found->second;
}

}  // namespace ajar
