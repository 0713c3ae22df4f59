#include "calibrato/page/page_access.h"

#include <sys/random.h>

#include <array>
#include <string_view>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

constexpr const char* kCookie = "calibrato_guide";

// From the system, not from an Rng: nobody may be able to guess it.
std::string NewSecret() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw InputError({"no random numbers from the system", "", "", "serve the page on loopback"});
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string secret;
  for (const unsigned char byte : bytes) {
    secret += kDigits[byte >> 4];
    secret += kDigits[byte & 15];
  }
  return secret;
}

// Takes as long for a good guess as for a bad one.
bool IsSame(const std::string& one, const std::string& other) {
  if (one.size() != other.size()) return false;
  unsigned char difference = 0;
  for (size_t k = 0; k < one.size(); ++k) {
    difference = static_cast<unsigned char>(difference | (one[k] ^ other[k]));
  }
  return difference == 0;
}

bool NamesLoopback(const std::string& host_and_port) {
  const std::string host = host_and_port.substr(0, host_and_port.find(':'));
  return host == "127.0.0.1" || host == "localhost";
}

}  // namespace

PageAccess::PageAccess(bool is_loopback, std::function<void(const std::string&)> on_new_token)
    : is_loopback_(is_loopback), on_new_token_(std::move(on_new_token)) {
  if (!is_loopback_) token_ = NewSecret();
  on_new_token_(token_);
}

std::optional<HttpResponse> PageAccess::Check(const HttpRequest& request) {
  if (is_loopback_) {
    const auto host = request.headers.find("host");
    if (host != request.headers.end() && NamesLoopback(host->second)) return std::nullopt;
    return ErrorResponse(403, "ask for this page as 127.0.0.1 or localhost");
  }
  std::string next_token;
  HttpResponse welcome;
  {
    const std::lock_guard lock(mutex_);
    const std::string cookie = request.Cookie(kCookie);
    for (const std::string& session : sessions_) {
      if (IsSame(session, cookie)) return std::nullopt;
    }
    const auto given = request.query.find("token");
    if (given == request.query.end() || !IsSame(given->second, token_)) {
      return ErrorResponse(
          403, "the address has no token, or one that was used: the terminal shows one");
    }
    const std::string session = NewSecret();
    sessions_.insert(session);
    token_ = NewSecret();
    next_token = token_;
    welcome.status = 303;
    welcome.headers["Location"] = "/";
    // Lax: Strict would not come along to "/" where the address was opened from a message.
    welcome.headers["Set-Cookie"] =
        std::string(kCookie) + "=" + session + "; HttpOnly; SameSite=Lax; Path=/";
  }
  on_new_token_(next_token);
  return welcome;
}

}  // namespace calibrato
