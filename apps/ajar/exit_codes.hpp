#pragma once

inline constexpr int kReached = 0;     ///< The goal was reached, or the files are right
inline constexpr int kNotReached = 1;  ///< The mission ended safely without reaching it
inline constexpr int kBadInput = 2;    ///< Bad input or usage
inline constexpr int kOurFault = 3;    ///< A fault of the program
