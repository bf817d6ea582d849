#pragma once

#include <string>

/// Prints a message on one line of standard error, whatever line breaks it has.
void complain(const std::string& text);
