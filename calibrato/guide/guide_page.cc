#include "calibrato/guide/guide_page.h"

#include <utility>

// The page, compiled in by assets.s.in.
extern "C" {
extern const char calibrato_guide_page[];
extern const char calibrato_guide_page_end[];
}

namespace calibrato {

GuidePage::GuidePage(const std::string& host, int port, Content content,
                     const std::function<void(const std::string&)>& on_address)
    : content_(std::move(content)),
      access_(host == "127.0.0.1",
              [this, host, on_address, is_first = true](const std::string& token) mutable {
                // The server, which knows the port, comes after the first token.
                if (std::exchange(is_first, false)) {
                  first_token_ = token;
                  return;
                }
                on_address(AddressFor(host, token));
              }),
      server_(
          host, port, [this](const HttpRequest& request) { return Answer(request); },
          "choose another --port, or a --host that is an address of this machine") {
  on_address(AddressFor(host, first_token_));
}

std::string GuidePage::AddressFor(const std::string& host, const std::string& token) const {
  const std::string address = "http://" + host + ":" + std::to_string(server_.port()) + "/";
  return token.empty() ? address : address + "?token=" + token;
}

HttpResponse GuidePage::Answer(const HttpRequest& request) {
  if (const auto refusal = access_.Check(request)) return *refusal;
  HttpResponse response;
  if (request.path == "/end") {
    // A link or an image on another page can't post with this header.
    if (request.method != "POST" || request.headers.count("x-calibrato") == 0) {
      return ErrorResponse(405, "to be posted by the page's own button");
    }
    content_.end();
    response.body = "ended\n";
    return response;
  }
  if (request.method != "GET") return ErrorResponse(405, "this page is only to be read");
  if (request.path == "/") {
    response.type = "text/html; charset=utf-8";
    response.body.assign(calibrato_guide_page, calibrato_guide_page_end);
  } else if (request.path == "/state") {
    response.type = "application/json";
    response.body = content_.state();
  } else if (request.path == "/frame") {
    response.type = "image/jpeg";
    response.body = content_.frame();
    // A recording may have lists of corners instead of images: that is no fault.
    if (response.body.empty()) response.status = 204;
  } else if (request.path == "/report") {
    response.type = "text/html; charset=utf-8";
    response.body = content_.report();
  }
  if (response.body.empty() && response.status == 200) {
    return ErrorResponse(404, "there are /, /state, /frame and /report");
  }
  return response;
}

}  // namespace calibrato
