#include "calibrato/page/http_message.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace calibrato {
namespace {

bool IsPrintable(char c) { return c >= 0x20 && c < 0x7f; }

bool IsNameCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

bool ParseRequestLine(std::string_view line, HttpRequest* request) {
  const std::vector<std::string_view> words = Split(line, ' ');
  if (words.size() != 3 || (words[2] != "HTTP/1.1" && words[2] != "HTTP/1.0")) return false;
  const auto is_capital = [](char c) { return c >= 'A' && c <= 'Z'; };
  if (words[0].empty() || !std::all_of(words[0].begin(), words[0].end(), is_capital)) return false;
  if (words[1].empty() || words[1].front() != '/') return false;
  request->method = words[0];
  const size_t question = words[1].find('?');
  request->path = words[1].substr(0, question);
  if (question == std::string_view::npos) return true;
  for (const std::string_view pair : Split(words[1].substr(question + 1), '&')) {
    const size_t equals = pair.find('=');
    if (equals == std::string_view::npos) continue;
    request->query[std::string(pair.substr(0, equals))] = pair.substr(equals + 1);
  }
  return true;
}

const char* ReasonOf(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 303:
      return "See Other";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 413:
      return "Content Too Large";
    default:
      return "Internal Server Error";
  }
}

}  // namespace

std::string HttpRequest::Cookie(const std::string& name) const {
  const auto found = headers.find("cookie");
  if (found == headers.end()) return "";
  for (const std::string_view part : Split(found->second, ';')) {
    const std::string_view cookie = Trimmed(part);
    if (cookie.size() > name.size() && cookie[name.size()] == '=' &&
        cookie.substr(0, name.size()) == name) {
      return std::string(cookie.substr(name.size() + 1));
    }
  }
  return "";
}

std::optional<HttpRequest> ParseHttpRequest(std::string_view head) {
  if (head.size() > kMaxRequestHead) return std::nullopt;
  HttpRequest request;
  bool is_first = true;
  while (true) {
    const size_t end = head.find("\r\n");
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = head.substr(0, end);
    head.remove_prefix(end + 2);
    if (!std::all_of(line.begin(), line.end(), IsPrintable)) return std::nullopt;
    if (is_first) {
      if (!ParseRequestLine(line, &request)) return std::nullopt;
      is_first = false;
      continue;
    }
    if (line.empty()) break;
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos || colon == 0) return std::nullopt;
    const std::string_view name = line.substr(0, colon);
    if (!std::all_of(name.begin(), name.end(), IsNameCharacter)) return std::nullopt;
    const bool is_new =
        request.headers.emplace(Lower(name), std::string(Trimmed(line.substr(colon + 1)))).second;
    // Two of a kind mean one thing to one reader and another to the next.
    if (!is_new && (Lower(name) == "host" || Lower(name) == "content-length")) return std::nullopt;
  }
  if (!head.empty()) return std::nullopt;
  const auto length = request.headers.find("content-length");
  request.has_body = (length != request.headers.end() && length->second != "0") ||
                     request.headers.count("transfer-encoding") > 0;
  return request;
}

HttpResponse ErrorResponse(int status, const std::string& words) {
  HttpResponse response;
  response.status = status;
  response.body = words + "\n";
  return response;
}

std::string HttpText(const HttpResponse& response) {
  // An answer without content says nothing of any (RFC 9110, 8.6).
  const std::string content =
      response.status == 204 ? ""
                             : "\r\nContent-Type: " + response.type +
                                   "\r\nContent-Length: " + std::to_string(response.body.size());
  std::string text = "HTTP/1.1 " + std::to_string(response.status) + " " +
                     ReasonOf(response.status) + content +
                     "\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff"
                     "\r\nX-Frame-Options: DENY\r\nReferrer-Policy: no-referrer"
                     "\r\nContent-Security-Policy: default-src 'self' 'unsafe-inline' data: blob:"
                     "\r\nConnection: close\r\n";
  for (const auto& [name, value] : response.headers) text += name + ": " + value + "\r\n";
  return text + "\r\n" + response.body;
}

}  // namespace calibrato
