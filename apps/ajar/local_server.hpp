#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

/// What a handler answers.
struct Answer {
  int status = 200;
  std::string type = "text/html; charset=utf-8";
  std::string body;
};

/// A web server for the people at this computer: it listens on the loopback address only, every path begins with a random
/// token of 128 bits, and requests under another host's name are refused. Handlers run on its own threads.
class LocalServer {
 public:
  using Handler = std::function<Answer(const std::string& tail)>;
  /// Appends what is new since `cursor`, waiting up to a second for it. @return false when nothing will follow
  using Source = std::function<bool(std::size_t& cursor, std::string& text)>;

  LocalServer();
  ~LocalServer();
  LocalServer(const LocalServer&) = delete;
  LocalServer& operator=(const LocalServer&) = delete;

  /// Answers GET TOKEN/NAME…; the handler gets what follows the name. Before start() only.
  void on_get(const std::string& name, const Handler& handler);
  /// Answers POST TOKEN/NAME.
  void on_post(const std::string& name, const Handler& handler);
  /// Sends server-sent events at TOKEN/NAME; a viewer that comes again goes on where it was.
  void on_events(const std::string& name, const Source& source);

  /// Takes a free port and begins to answer. @throws ajar::IoError
  void start();
  void stop() noexcept;

  /// Where a browser finds it: http://127.0.0.1:PORT/TOKEN/
  [[nodiscard]] const std::string& address() const noexcept;
  /// Viewers that follow the events now.
  [[nodiscard]] int viewers() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
