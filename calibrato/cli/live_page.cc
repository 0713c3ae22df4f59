#include "calibrato/cli/live_page.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr int kPollMs = 100;
constexpr int kPatienceMs = 2000;  // With a browser that says nothing.
constexpr size_t kMaxRequestBytes = 16384;

// Until the empty line that ends a request's head. Empty if it does not come, or too late.
std::string ReadRequest(int connection) {
  std::string request;
  char buffer[2048];
  while (request.find("\r\n\r\n") == std::string::npos && request.size() < kMaxRequestBytes) {
    pollfd waiting{connection, POLLIN, 0};
    if (poll(&waiting, 1, kPatienceMs) <= 0) return "";
    const ssize_t size = recv(connection, buffer, sizeof buffer, 0);
    if (size <= 0) return "";
    request.append(buffer, static_cast<size_t>(size));
  }
  return request.size() < kMaxRequestBytes ? request : "";
}

void SendAll(int connection, const std::string& bytes) {
  size_t sent = 0;
  while (sent < bytes.size()) {
    pollfd waiting{connection, POLLOUT, 0};
    if (poll(&waiting, 1, kPatienceMs) <= 0) return;
    const ssize_t size = send(connection, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (size <= 0) return;
    sent += static_cast<size_t>(size);
  }
}

std::string Response(const std::string& status, const std::string& type, const std::string& body) {
  return "HTTP/1.1 " + status + "\r\nContent-Type: " + type +
         "; charset=utf-8\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\nCache-Control: no-store\r\nConnection: close\r\nRefresh: 5\r\n\r\n" + body;
}

[[noreturn]] void Fail(int port) {
  throw InputError({"cannot open the live page", "port " + std::to_string(port),
                    std::strerror(errno), "choose another --live port"});
}

}  // namespace

LivePage::LivePage(int port, Content content) : content_(std::move(content)) {
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) Fail(port);
  const int yes = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  socklen_t size = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (bind(socket_, generic, size) != 0 || listen(socket_, 8) != 0 ||
      getsockname(socket_, generic, &size) != 0) {
    const int error = errno;
    close(socket_);
    errno = error;
    Fail(port);
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { Serve(); });
}

LivePage::~LivePage() {
  stop_ = true;
  thread_.join();
  close(socket_);
}

std::string LivePage::address() const { return "http://127.0.0.1:" + std::to_string(port_) + "/"; }

void LivePage::Serve() {
  while (!stop_) {
    pollfd waiting{socket_, POLLIN, 0};
    if (poll(&waiting, 1, kPollMs) <= 0) continue;
    const int connection = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) continue;
    Answer(connection);
    close(connection);
  }
}

void LivePage::Answer(int connection) const {
  const std::string request = ReadRequest(connection);
  if (request.empty()) return;
  try {
    if (request.rfind("GET / ", 0) == 0) {
      SendAll(connection, Response("200 OK", "text/html", content_.page()));
    } else if (request.rfind("GET /data ", 0) == 0) {
      SendAll(connection, Response("200 OK", "application/json", content_.data()));
    } else {
      SendAll(connection, Response("404 Not Found", "text/plain", "there are / and /data\n"));
    }
  } catch (const std::exception& error) {
    // Nothing that a browser asks for may end the command.
    SendAll(connection, Response("500 Internal Server Error", "text/plain", error.what()));
  }
}

}  // namespace calibrato
