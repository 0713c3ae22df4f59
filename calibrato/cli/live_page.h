#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

namespace calibrato {

/// A page that shows what a running command does: a web server for one's own browser, on the
/// loopback interface alone. It answers GET / with the page made anew, GET /data with the bare
/// numbers, anything else with an error, one request at a time, and asks browsers to come again
/// every few seconds.
class LivePage {
 public:
  /// What to answer with. Called on the server's thread.
  struct Content {
    std::function<std::string()> page;  ///< HTML
    std::function<std::string()> data;  ///< JSON, one object or array a line
  };

  /// @param port  1 to 65535, or 0 for any that is free.
  /// @throws InputError if it can't be had.
  LivePage(int port, Content content);
  ~LivePage();
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string address() const;  ///< "http://127.0.0.1:8080/"

 private:
  void Serve();
  void Answer(int connection) const;

  Content content_;
  int socket_ = -1;
  int port_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace calibrato
