#include "local_server.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <charconv>
#include <random>
#include <thread>

#include "ajar/core/error.hpp"

namespace {

constexpr const char* kHost = "127.0.0.1";
/// Viewers at a time; each keeps one thread.
constexpr int kViewers = 4;
constexpr int kThreads = kViewers + 3;

std::string random_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

std::size_t number_or_zero(const std::string& text) {
  std::size_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void send(const Answer& answer, httplib::Response& response) {
  response.status = answer.status;
  response.set_content(answer.body, answer.type);
}

}  // namespace

struct LocalServer::Impl {
  httplib::Server http;
  std::string token = random_token();
  std::string host;
  std::string address;
  std::thread thread;
  std::atomic<int> viewers{0};

  [[nodiscard]] std::string pattern(const std::string& name) const { return "/" + token + "/" + name; }

  /// A page of another site that resolves its own name to this computer must get nothing.
  [[nodiscard]] bool foreign(const httplib::Request& request) const {
    const std::string named = request.get_header_value("Host");
    return named != host && named != "localhost" + host.substr(host.find(':'));
  }
};

LocalServer::LocalServer() : impl_(std::make_unique<Impl>()) {
  httplib::Server& http = impl_->http;
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_write_timeout(std::chrono::seconds(5));
  http.set_keep_alive_timeout(1);
  http.set_default_headers(
      {{"Cache-Control", "no-store"}, {"Referrer-Policy", "no-referrer"}, {"X-Content-Type-Options", "nosniff"}});
  http.set_pre_routing_handler([impl = impl_.get()](const httplib::Request& request, httplib::Response& response) {
    if (!impl->foreign(request)) return httplib::Server::HandlerResponse::Unhandled;
    send({403, "text/plain", "ajar: unknown host\n"}, response);
    return httplib::Server::HandlerResponse::Handled;
  });
  http.set_exception_handler([](const httplib::Request&, httplib::Response& response, const std::exception_ptr& thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
      send({500, "text/plain; charset=utf-8", std::string("ajar: ") + error.what() + "\n"}, response);
    }
  });
}

LocalServer::~LocalServer() { stop(); }

void LocalServer::on_get(const std::string& name, const Handler& handler) {
  impl_->http.Get(impl_->pattern(name) + "([0-9]*)",
                  [handler](const httplib::Request& request, httplib::Response& response) {
                    send(handler(request.matches[1].str()), response);
                  });
}

void LocalServer::on_post(const std::string& name, const Handler& handler) {
  impl_->http.Post(impl_->pattern(name),
                   [handler](const httplib::Request&, httplib::Response& response) { send(handler({}), response); });
}

void LocalServer::on_events(const std::string& name, const Source& source) {
  impl_->http.Get(
      impl_->pattern(name), [impl = impl_.get(), source](const httplib::Request& request, httplib::Response& response) {
        if (impl->viewers.fetch_add(1) >= kViewers) {
          --impl->viewers;
          send({503, "text/plain", "ajar: too many viewers\n"}, response);
          return;
        }
        const auto cursor = std::make_shared<std::size_t>(number_or_zero(request.get_header_value("Last-Event-ID")));
        response.set_chunked_content_provider(
            "text/event-stream",
            [source, cursor](std::size_t, httplib::DataSink& sink) {
              std::string text;
              const bool more = source(*cursor, text);
              if (text.empty()) text = ":\n\n";  // a sign of life, so that a viewer that has left is noticed
              if (!sink.write(text.data(), text.size())) return false;
              if (!more) sink.done();
              return true;
            },
            [impl](bool) { --impl->viewers; });
      });
}

void LocalServer::start() {
  const int port = impl_->http.bind_to_any_port(kHost);
  if (port <= 0) throw ajar::IoError("cannot listen on 127.0.0.1: no free port");
  impl_->host = fmt::format("{}:{}", kHost, port);
  impl_->address = fmt::format("http://{}/{}/", impl_->host, impl_->token);
  impl_->thread = std::thread([impl = impl_.get()] { impl->http.listen_after_bind(); });
}

void LocalServer::stop() noexcept {
  if (!impl_->thread.joinable()) return;
  while (!impl_->http.is_running()) std::this_thread::yield();  // stop() before the loop runs would be lost
  impl_->http.stop();
  impl_->thread.join();
}

const std::string& LocalServer::address() const noexcept { return impl_->address; }

int LocalServer::viewers() const noexcept { return impl_->viewers.load(); }
