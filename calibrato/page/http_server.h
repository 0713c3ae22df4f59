#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "calibrato/page/http_message.h"

namespace calibrato {

/// A small web server for the page of a running command. It serves what its handler makes, no
/// files; what a browser, or something that is none, can do to it is bounded:
/// - a request's head is at most kMaxRequestHead long and must arrive within two seconds, and be
///   well formed; else it is answered 400, or not at all;
/// - bodies are refused (413) unread;
/// - so many connections are served at a time, each for one request; others wait in the queue of
///   the system;
/// - what a handler throws is answered 500.
class HttpServer {
 public:
  /// Called on several threads at once.
  using Handler = std::function<HttpResponse(const HttpRequest&)>;

  /// @param host  A numeric IPv4 address of this machine: "127.0.0.1", or "0.0.0.0" for all.
  /// @param port  1 to 65535, or 0 for any that is free.
  /// @param remedy  What to try if it can't be had: which options choose it.
  /// @throws InputError if it can't be had.
  HttpServer(const std::string& host, int port, Handler handler, const std::string& remedy);
  /// Requests that are being answered are waited for.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const { return port_; }

 private:
  void Accept();
  void Answer(int connection) const;

  Handler handler_;
  int socket_ = -1;
  int port_ = 0;
  std::atomic<bool> stop_ = false;
  std::atomic<int> num_connections_ = 0;
  std::thread thread_;
};

}  // namespace calibrato
