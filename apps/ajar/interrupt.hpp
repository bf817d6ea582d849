#pragma once

#include <atomic>

/// Becomes true at the first Ctrl-C (or SIGTERM), which asks for a safe stop; a second one ends the program at once.
[[nodiscard]] const std::atomic<bool>& interrupted();

/// Asks for the same safe stop as the first Ctrl-C. From any thread.
void request_stop() noexcept;
