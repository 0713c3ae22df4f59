#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "calibrato/page/http_message.h"

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

}  // namespace calibrato
