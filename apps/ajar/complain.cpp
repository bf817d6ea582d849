#include "complain.hpp"

#include <fmt/format.h>

#include <cstdio>

void complain(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const bool blank = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (blank && (line.empty() || line.back() == ' ')) continue;
    line += blank ? ' ' : c;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  fmt::print(stderr, "ajar: {}\n", line);
}
