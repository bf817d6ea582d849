#pragma once

#include <CLI/CLI.hpp>

/// Each command adds its options and leaves its exit code when it is chosen. The exit codes stand in exit_codes.hpp.
void add_run(CLI::App& program, int& exit_code);
void add_campaign(CLI::App& program, int& exit_code);
void add_identify(CLI::App& program, int& exit_code);
void add_validate(CLI::App& program, int& exit_code);
void add_report(CLI::App& program, int& exit_code);
void add_view(CLI::App& program, int& exit_code);
void add_reproduce(CLI::App& program, int& exit_code);
