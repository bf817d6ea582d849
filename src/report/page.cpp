#include "page.hpp"

#include <stdexcept>

#include "ajar/core/markup.hpp"

namespace ajar::page {
namespace {

constexpr std::string_view kTitle = "<title>Ajar</title>";
constexpr std::string_view kSlot = R"(<script id="data" type="application/json">)";

/// JSON inside of an HTML script element: nothing in it may look like a tag.
std::string for_script(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    switch (c) {
      case '<': out += "\\u003c"; break;
      case '>': out += "\\u003e"; break;
      case '&': out += "\\u0026"; break;
      default: out += c;
    }
  }
  return out;
}

}  // namespace

std::string dump(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string fill(const std::string& title, const std::string& data) {
  const std::size_t head = kPage.find(kTitle), slot = kPage.find(kSlot);
  if (head == std::string_view::npos || slot == std::string_view::npos || slot < head) {
    throw std::logic_error("web/dist/page.html has no title or no slot for its data");
  }
  std::string out(kPage.substr(0, head));
  out += "<title>" + escape_markup(title) + " - Ajar</title>";
  const std::size_t rest = head + kTitle.size(), end = slot + kSlot.size();
  out += kPage.substr(rest, end - rest);
  out += for_script(data);
  out += kPage.substr(end);
  return out;
}

}  // namespace ajar::page
