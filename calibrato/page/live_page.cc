#include "calibrato/page/live_page.h"

#include <exception>
#include <utility>

namespace calibrato {

LivePage::LivePage(int port, const std::string& option, Content content)
    : content_(std::move(content)),
      access_(true, [](const std::string& /*token*/) {}),
      server_(
          "127.0.0.1", port, [this](const HttpRequest& request) { return Answer(request); },
          "choose another " + option + " port") {}

std::string LivePage::address() const {
  return "http://127.0.0.1:" + std::to_string(server_.port()) + "/";
}

HttpResponse LivePage::Answer(const HttpRequest& request) {
  if (const auto refusal = access_.Check(request)) return *refusal;
  if (request.method != "GET") return ErrorResponse(405, "this page is only to be read");
  HttpResponse response;
  if (request.path == "/") {
    try {
      response.type = "text/html; charset=utf-8";
      response.body = content_.page();
    } catch (const std::exception& error) {
      response = ErrorResponse(500, error.what());
    }
    // Of an error too: what is not there yet may be the next time.
    response.headers["Refresh"] = "5";
  } else if (request.path == "/data") {
    response.type = "application/json; charset=utf-8";
    response.body = content_.data();
  } else {
    return ErrorResponse(404, "there are / and /data");
  }
  return response;
}

}  // namespace calibrato
