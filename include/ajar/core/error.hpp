#pragma once

#include <stdexcept>
#include <string>

namespace ajar {

/// Anything that goes wrong while setting up. Run-time steps never throw; they return a status.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A value that is out of range, missing, unknown or contradictory; names where, value and what is allowed.
class ConfigError : public Error {
 public:
  using Error::Error;
};

/// A robot or mechanism description that cannot be used.
class ModelError : public Error {
 public:
  using Error::Error;
};

/// A plant that cannot be built or started.
class PlantError : public Error {
 public:
  using Error::Error;
};

/// A file or folder that cannot be read or written.
class IoError : public Error {
 public:
  using Error::Error;
};

}  // namespace ajar
