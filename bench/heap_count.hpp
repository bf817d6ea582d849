#pragma once

/// Requests to the C heap since the start of the process.
extern "C" long ajar_heap_count() noexcept;
