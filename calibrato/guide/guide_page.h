#pragma once

#include <functional>
#include <string>

#include "calibrato/page/http_server.h"
#include "calibrato/page/page_access.h"

namespace calibrato {

/// The page that guides: GET / the page, GET /state what it shows, GET /frame the latest image,
/// GET /report the report once there is one, POST /end to end the recording. Nothing else is there.
class GuidePage {
 public:
  /// What to answer with, called on several threads; an empty text is answered by 404, but an empty
  /// image by 204, No Content: there is a /frame, and nothing in it.
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
