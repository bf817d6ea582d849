#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace ajar::page {

/// The page as web/ builds it, in which a slot waits for the data; compiled into the library from web/dist/page.html.
extern const std::string_view kPage;

/// The page with its data and title in place. `data` is JSON.
[[nodiscard]] std::string fill(const std::string& title, const std::string& data);

/// JSON as text; what is not UTF-8 is replaced.
[[nodiscard]] std::string dump(const nlohmann::ordered_json& json);

}  // namespace ajar::page
