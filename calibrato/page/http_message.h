#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

// As much of HTTP/1.1 as a page for one's own browser needs: requests without a body, answers with
// one, a connection each.

namespace calibrato {

/// The longest head of a request that is read [bytes].
inline constexpr size_t kMaxRequestHead = 16384;

struct HttpRequest {
  std::string method;                          ///< "GET"
  std::string path;                            ///< "/state", without what follows a '?'.
  std::map<std::string, std::string> query;    ///< "?a=1&b=2"; not unescaped.
  std::map<std::string, std::string> headers;  ///< Names in lower case.
  /// True where a body was announced, by Content-Length above 0 or any Transfer-Encoding.
  bool has_body = false;
  /// The value of a cookie, or empty.
  [[nodiscard]] std::string Cookie(const std::string& name) const;
};

/// A head up to and with its empty line.
/// @return nothing unless it is well formed: a method of capital letters, a target that begins with
/// '/', HTTP/1.0 or 1.1, headers of a name and a value each, lines that end in CR LF, all of it
/// printable ASCII.
[[nodiscard]] std::optional<HttpRequest> ParseHttpRequest(std::string_view head);

struct HttpResponse {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::map<std::string, std::string> headers;  ///< Beside those that every answer has.
};

/// An answer of one line of plain text, for what is not served.
[[nodiscard]] HttpResponse ErrorResponse(int status, const std::string& words);

/// The answer's bytes. Every one forbids caching, framing, and whatever comes from elsewhere.
[[nodiscard]] std::string HttpText(const HttpResponse& response);

}  // namespace calibrato
