#include "calibrato/page/http_message.h"

#include <gtest/gtest.h>

#include <string>

#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

TEST(ParseHttpRequest, ReadsWhatABrowserSends) {
  const auto request = ParseHttpRequest(
      "GET /state?token=ab12&x HTTP/1.1\r\nHost: 127.0.0.1:8080\r\n"
      "Cookie: other=1; calibrato_guide=77aa\r\nAccept: */*\r\n\r\n");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->method, "GET");
  EXPECT_EQ(request->path, "/state");
  EXPECT_EQ(request->query.at("token"), "ab12");
  EXPECT_EQ(request->headers.at("host"), "127.0.0.1:8080");
  EXPECT_EQ(request->Cookie("calibrato_guide"), "77aa");
  EXPECT_EQ(request->Cookie("calibrato"), "");
  EXPECT_FALSE(request->has_body);
}

TEST(ParseHttpRequest, SeesABodyComing) {
  const std::string head = "POST /end HTTP/1.1\r\nHost: localhost\r\n";
  EXPECT_FALSE(ParseHttpRequest(head + "Content-Length: 0\r\n\r\n")->has_body);
  EXPECT_TRUE(ParseHttpRequest(head + "Content-Length: 1000000000\r\n\r\n")->has_body);
  EXPECT_TRUE(ParseHttpRequest(head + "Content-Length: -1\r\n\r\n")->has_body);
  EXPECT_TRUE(ParseHttpRequest(head + "Transfer-Encoding: chunked\r\n\r\n")->has_body);
}

TEST(ParseHttpRequest, RefusesWhatIsNotWellFormed) {
  for (const std::string head :
       {"", "\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/2.0\r\n\r\n", "get / HTTP/1.1\r\n\r\n",
        "GET  / HTTP/1.1\r\n\r\n", "GET state HTTP/1.1\r\n\r\n",
        "GET http://elsewhere/ HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\n\n", "GET / HTTP/1.1\r\n",
        "GET / HTTP/1.1\r\nNoColon\r\n\r\n", "GET / HTTP/1.1\r\n: empty\r\n\r\n",
        "GET / HTTP/1.1\r\nBad Name: x\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n",
        "GET / HTTP/1.1\r\n\r\nmore", "GET /\x01 HTTP/1.1\r\n\r\n", "GET /\xff HTTP/1.1\r\n\r\n"}) {
    EXPECT_FALSE(ParseHttpRequest(head)) << head;
  }
  EXPECT_FALSE(
      ParseHttpRequest("GET / HTTP/1.1\r\nX: " + std::string(kMaxRequestHead, 'a') + "\r\n\r\n"));
}

// Whatever comes, it ends, and what it calls a request is one. Changes of good requests reach
// deeper than noise.
TEST(ParseHttpRequest, SurvivesAnyBytes) {
  const std::string good =
      "GET /state?token=ab12&x=3 HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nCookie: a=1; b=2\r\n"
      "Content-Length: 0\r\n\r\n";
  Rng rng(5);
  int num_parsed = 0;
  for (int k = 0; k < 100'000; ++k) {
    std::string head = good;
    const auto num_changes = 1 + rng.UniformIndex(6);
    for (uint64_t change = 0; change < num_changes && !head.empty(); ++change) {
      const size_t at = rng.UniformIndex(head.size());
      switch (rng.UniformIndex(4)) {
        case 0:
          head[at] = static_cast<char>(rng.NextBits());
          break;
        case 1:
          head.erase(at, 1 + rng.UniformIndex(8));
          break;
        case 2:
          head.insert(at, head.substr(rng.UniformIndex(head.size()), rng.UniformIndex(20)));
          break;
        default:
          head.insert(at, 1, "\r\n: ;=&?/%"[rng.UniformIndex(10)]);
      }
    }
    const auto request = ParseHttpRequest(head);
    if (!request) continue;
    ++num_parsed;
    ASSERT_EQ(request->path.front(), '/');
    ASSERT_EQ(request->path.find('?'), std::string::npos);
    static_cast<void>(request->Cookie("b"));
  }
  EXPECT_GT(num_parsed, 1000);
}

}  // namespace
}  // namespace calibrato
