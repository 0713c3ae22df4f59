#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "calibrato/guide/http_server.h"

namespace calibrato {

/// Who may see the page.
///
/// On the loopback interface: whoever asks for it by its own name or address, so that a page from
/// elsewhere, whose name was pointed here, may not. On the network: browsers that came with the
/// token of the moment in their address. It is good for one browser, which gets a cookie for it;
/// then there is a new one, for the next browser.
class PageAccess {
 public:
  /// @param on_new_token  Called with each token, the first one at once; empty on loopback.
  PageAccess(bool is_loopback, std::function<void(const std::string&)> on_new_token);

  /// @return nothing where the request may be answered; else what to answer instead: a refusal, or,
  /// to the first that comes with the token, where to go on.
  [[nodiscard]] std::optional<HttpResponse> Check(const HttpRequest& request);

 private:
  bool is_loopback_;
  std::function<void(const std::string&)> on_new_token_;
  std::mutex mutex_;
  std::string token_;
  std::set<std::string> sessions_;
};

/// The page that guides: GET / the page, GET /state what it shows, GET /frame the latest image,
/// GET /report the report once there is one, POST /end to end the recording. Nothing else is there.
class GuidePage {
 public:
  /// What to answer with, called on several threads; an empty text is answered by 404.
  struct Content {
    std::function<std::string()> state;   ///< JSON
    std::function<std::string()> frame;   ///< JPEG
    std::function<std::string()> report;  ///< HTML
    std::function<void()> end;
  };
  /// @param on_address  Called with each address to open: once on loopback; on the network again
  /// whenever a browser used the one before.
  /// @throws InputError as HttpServer.
  GuidePage(const std::string& host, int port, Content content,
            const std::function<void(const std::string&)>& on_address);

  [[nodiscard]] int port() const { return server_.port(); }

 private:
  [[nodiscard]] HttpResponse Answer(const HttpRequest& request);
  [[nodiscard]] std::string AddressFor(const std::string& host, const std::string& token) const;

  Content content_;
  std::string first_token_;
  PageAccess access_;
  HttpServer server_;
};

}  // namespace calibrato
