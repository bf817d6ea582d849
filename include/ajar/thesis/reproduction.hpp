#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ajar/thesis/experiment.hpp"
#include "ajar/thesis/figure.hpp"

namespace ajar {

/// One statement of the thesis that can be checked.
struct ThesisStatement {
  std::string figure;               ///< Or chapter
  std::string statement;            ///< What the thesis says
  std::optional<double> thesis;     ///< The number that it states, none if it states none
  std::optional<double> corrected;  ///< What its law gives with the printed errors mended
  std::optional<double> ours;       ///< What the default controller gives on the same task
  std::string unit;
  bool holds = false;  ///< For the thesis's law as mended
  std::string reason;  ///< Why, with the numbers that tell
};

/// Everything that the reproduction gives.
struct Reproduction {
  std::vector<Figure> figures;
  std::vector<ThesisStatement> statements;
};

struct ReproduceOptions {
  std::vector<std::string> figures;  ///< Such as 6.6; empty = all
  int threads = 2;
  std::function<void(const std::string&)> progress;  ///< Told what is done, from the calling thread
};

/// Names of the figures that can be reproduced, in order.
[[nodiscard]] const std::vector<std::string>& thesis_figures();

/// Runs the thesis's experiments and writes thesis.html, thesis.json, figures/*.svg and runs/NAME/ into a folder.
/// @throws ConfigError for an unknown figure (lists the valid ones), IoError before the first run if the folder cannot be
///         written, and whatever a run throws
Reproduction reproduce_thesis(const PlantFactory& factory, const std::filesystem::path& folder,
                              const ReproduceOptions& options);

/// thesis.json: a list of {figure, statement, thesis, corrected, ours, unit, holds, reason}.
[[nodiscard]] std::string to_json(const std::vector<ThesisStatement>& statements);

/// thesis.html: the table and the figures in one file that opens from disk.
[[nodiscard]] std::string to_html(const Reproduction& reproduction);

}  // namespace ajar
