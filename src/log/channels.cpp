#include "ajar/log/channels.hpp"

#include <algorithm>
#include <limits>

#include "ajar/core/error.hpp"

namespace ajar {

std::size_t ChannelList::add(const std::string& name, const std::string& unit, ChannelKind kind) {
  if (name.empty() || name.find_first_of(",\"\r\n") != std::string::npos) {
    throw ConfigError("log channel: name '" + name +
                      "' is not usable; allowed: any text without comma, quote or line break");
  }
  const bool taken = std::any_of(infos_.begin(), infos_.end(), [&](const ChannelInfo& info) { return info.name == name; });
  if (taken) throw ConfigError("log channel: name '" + name + "' is taken; names must differ");
  infos_.push_back({name, unit, kind});
  return infos_.size() - 1;
}

NumberChannel ChannelList::number(const std::string& name, const std::string& unit) {
  return {add(name, unit, ChannelKind::Number)};
}

IntegerChannel ChannelList::integer(const std::string& name, const std::string& unit) {
  return {add(name, unit, ChannelKind::Integer)};
}

TextChannel ChannelList::text(const std::string& name) { return {add(name, "", ChannelKind::Text)}; }

LogRow::LogRow(const ChannelList& channels) : cells_(channels.size()) {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    switch (channels.infos()[i].kind) {
      case ChannelKind::Number: cells_[i].number = std::numeric_limits<double>::quiet_NaN(); break;
      case ChannelKind::Integer: cells_[i].integer = 0; break;
      case ChannelKind::Text: cells_[i].text = nullptr; break;
    }
  }
}

}  // namespace ajar
