#include "base_scenario.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

/// A file that goes away with its owner; its name is unique among processes and threads.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text) {
    static std::atomic<unsigned> counter{0};
    path_ = std::filesystem::temp_directory_path() / fmt::format("ajar-base-{}-{}.toml", ::getpid(), counter++);
    std::ofstream stream(path_, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw IoError("cannot write '" + path_.string() + "'");
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

Scenario scenario_from_text(const std::string& text, const std::vector<std::string>& overrides) {
  const TemporaryFile file(text);
  try {
    return load_scenario(file.path(), overrides);
  } catch (const ConfigError& error) {
    // The reader of the message never sees this file: its name and line say nothing to him.
    std::string message = error.what();
    const std::string name = file.path().string() + ":";
    if (message.rfind(name, 0) == 0) message = message.substr(message.find(' ', name.size() - 1) + 1);
    throw ConfigError(message);
  }
}

}  // namespace ajar
