#include "ajar/report/report.hpp"
#include "page.hpp"
#include "run_files.hpp"

namespace ajar {

std::string make_live_page(const std::filesystem::path& run_folder, const LivePage& live) {
  const nlohmann::ordered_json scene = page::read_json(run_folder / "scene.json");
  const std::string name = folder_name(run_folder);
  const nlohmann::ordered_json run = {{"name", name},
                                      {"result", nullptr},
                                      {"scene", scene},
                                      {"scenario", page::read_text(run_folder / "scenario.toml")},
                                      {"slide", live.slide},
                                      {"cut_off", false},
                                      {"joints", live.joints},
                                      {"rows", 0},
                                      {"log_rows", 0},
                                      {"phase_names", live.phase_names},
                                      {"columns", live.columns},
                                      {"data", ""}};
  return page::fill("Live: " + name, page::dump({{"kind", "live"}, {"run", run}}));
}

}  // namespace ajar
