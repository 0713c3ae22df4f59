#pragma once

#include <functional>
#include <string>

#include "calibrato/page/http_server.h"
#include "calibrato/page/page_access.h"

namespace calibrato {

/// A page that shows what a running command does, to browsers of this machine alone
/// (page_access.h). It answers GET / with the page made anew, GET /data with the bare numbers,
/// anything else with an error, and asks browsers to come again every few seconds.
class LivePage {
 public:
  /// What to answer with. Called on several threads at once.
  struct Content {
    std::function<std::string()> page;  ///< HTML
    std::function<std::string()> data;  ///< JSON, one object or array a line
  };

  /// @param port  1 to 65535, or 0 for any that is free.
  /// @param option  That chooses the port, for the error's remedy: "--live".
  /// @throws InputError if it can't be had.
  LivePage(int port, const std::string& option, Content content);

  [[nodiscard]] int port() const { return server_.port(); }
  [[nodiscard]] std::string address() const;  ///< "http://127.0.0.1:8080/"

 private:
  [[nodiscard]] HttpResponse Answer(const HttpRequest& request);

  Content content_;
  PageAccess access_;
  HttpServer server_;
};

}  // namespace calibrato
