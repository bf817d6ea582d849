#pragma once

#include <string>
#include <vector>

#include "ajar/core/types.hpp"
#include "ajar/log/csv_table.hpp"

namespace ajar {

/// Columns of a log by name; one that the log does not have reads as nothing (NaN).
class LogColumns {
 public:
  using Column = std::vector<double>;

  explicit LogColumns(CsvTable table);

  [[nodiscard]] const Column& operator[](const std::string& name) const;
  [[nodiscard]] bool has(const std::string& name) const { return table_.numbers.count(name) > 0; }
  [[nodiscard]] const CsvTable& table() const { return table_; }
  [[nodiscard]] std::size_t rows() const { return table_.rows; }
  [[nodiscard]] const std::vector<std::string>& phases() const { return table_.texts.at("phase"); }

 private:
  CsvTable table_;
  Column empty_;
};

/// Three columns NAME_x, NAME_y, NAME_z.
class VectorColumns {
 public:
  VectorColumns(const LogColumns& log, const std::string& name)
      : x_(log[name + "_x"]), y_(log[name + "_y"]), z_(log[name + "_z"]) {}
  [[nodiscard]] Vector3d operator[](std::size_t i) const { return {x_[i], y_[i], z_[i]}; }

 private:
  const LogColumns::Column &x_, &y_, &z_;
};

/// Four columns NAMEw … NAMEz of an orientation; none at all where they are missing.
class TurnColumns {
 public:
  TurnColumns(const LogColumns& log, const std::string& name)
      : w_(log[name + "w"]), x_(log[name + "x"]), y_(log[name + "y"]), z_(log[name + "z"]) {}
  [[nodiscard]] Eigen::Quaterniond operator[](std::size_t i) const {
    const Eigen::Quaterniond turn(w_[i], x_[i], y_[i], z_[i]);
    return turn.coeffs().allFinite() ? turn : Eigen::Quaterniond::Identity();
  }

 private:
  const LogColumns::Column &w_, &x_, &y_, &z_;
};

}  // namespace ajar
