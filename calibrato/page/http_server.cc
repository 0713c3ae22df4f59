#include "calibrato/page/http_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <exception>
#include <optional>
#include <system_error>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMs = 50;
constexpr std::chrono::milliseconds kToAsk{2000};
constexpr std::chrono::milliseconds kToListen{5000};
constexpr int kMaxConnections = 16;

int MillisecondsUntil(Clock::time_point deadline) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
  return static_cast<int>(std::max<int64_t>(0, left.count()));
}

bool WaitFor(int connection, short event, Clock::time_point deadline) {
  pollfd waiting{connection, event, 0};
  return poll(&waiting, 1, MillisecondsUntil(deadline)) > 0;
}

// Up to and with the empty line that ends a head: nothing where it does not come in time, an empty
// text where it is too long. What follows it stays behind, unread or not.
std::optional<std::string> ReadHead(int connection) {
  const Clock::time_point deadline = Clock::now() + kToAsk;
  std::string head;
  char buffer[2048];
  while (head.size() <= kMaxRequestHead) {
    if (!WaitFor(connection, POLLIN, deadline)) return std::nullopt;
    const ssize_t size = recv(connection, buffer, sizeof buffer, 0);
    if (size <= 0) return std::nullopt;
    const size_t seen = head.size();
    head.append(buffer, static_cast<size_t>(size));
    const size_t end = head.find("\r\n\r\n", seen < 3 ? 0 : seen - 3);
    if (end != std::string::npos) return head.substr(0, end + 4);
  }
  return "";
}

void SendAll(int connection, const std::string& bytes) {
  const Clock::time_point deadline = Clock::now() + kToListen;
  size_t sent = 0;
  while (sent < bytes.size()) {
    if (!WaitFor(connection, POLLOUT, deadline)) return;
    const ssize_t size =
        send(connection, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (size <= 0) return;
    sent += static_cast<size_t>(size);
  }
}

// A connection that is closed over unread bytes takes the answer with it: a little of what is still
// on its way is let in, and thrown away.
void Close(int connection) {
  constexpr size_t kLittle = size_t{1} << 20;
  shutdown(connection, SHUT_WR);
  const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds(200);
  char buffer[16384];
  for (size_t seen = 0; seen < kLittle && WaitFor(connection, POLLIN, deadline);) {
    const ssize_t size = recv(connection, buffer, sizeof buffer, MSG_DONTWAIT);
    if (size <= 0) break;
    seen += static_cast<size_t>(size);
  }
  close(connection);
}

[[noreturn]] void Fail(const std::string& host, int port, const std::string& why,
                       const std::string& remedy) {
  throw InputError({"cannot open the page", host + " port " + std::to_string(port), why, remedy});
}

}  // namespace

HttpServer::HttpServer(const std::string& host, int port, Handler handler,
                       const std::string& remedy)
    : handler_(std::move(handler)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    Fail(host, port, "not an address as 192.168.1.5", remedy);
  }
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) Fail(host, port, std::generic_category().message(errno), remedy);
  const int yes = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  socklen_t size = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (bind(socket_, generic, size) != 0 || listen(socket_, 64) != 0 ||
      getsockname(socket_, generic, &size) != 0) {
    const int error = errno;
    close(socket_);
    Fail(host, port, std::generic_category().message(error), remedy);
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { Accept(); });
}

HttpServer::~HttpServer() {
  stop_ = true;
  thread_.join();
  close(socket_);
  while (num_connections_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void HttpServer::Accept() {
  while (!stop_) {
    if (num_connections_ >= kMaxConnections) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    pollfd waiting{socket_, POLLIN, 0};
    if (poll(&waiting, 1, kPollMs) <= 0) continue;
    const int connection = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) continue;
    ++num_connections_;
    try {
      std::thread([this, connection] {
        Answer(connection);
        Close(connection);
        --num_connections_;
      }).detach();
    } catch (const std::system_error&) {  // No thread to be had: that browser may ask again.
      close(connection);
      --num_connections_;
    }
  }
}

void HttpServer::Answer(int connection) const {
  try {
    const std::optional<std::string> head = ReadHead(connection);
    if (!head) return;
    const std::optional<HttpRequest> request = ParseHttpRequest(*head);
    HttpResponse response;
    if (!request) {
      response = ErrorResponse(400, "not a request that this page knows");
    } else if (request->has_body) {
      response = ErrorResponse(413, "this page takes nothing");
    } else {
      response = handler_(*request);
    }
    SendAll(connection, HttpText(response));
  } catch (const std::exception& error) {
    SendAll(connection, HttpText(ErrorResponse(500, error.what())));
  }
}

}  // namespace calibrato
