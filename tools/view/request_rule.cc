#include "tools/view/request_rule.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace sinew::live {

namespace {

constexpr std::size_t kShortestToken = 16;

}  // namespace

bool EqualInConstantTime(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0u : 1u;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

RequestRule::RequestRule(const std::string& address, unsigned port, std::string token)
    : token_(std::move(token)) {
  if (token_.size() < kShortestToken) {
    throw std::invalid_argument("token of " + std::to_string(token_.size()) +
                                " characters, expected at least " + std::to_string(kShortestToken));
  }
  for (const std::string& host : {address, std::string("127.0.0.1"), std::string("localhost")}) {
    hosts_.push_back(host + ":" + std::to_string(port));
  }
}

std::string RequestRule::WhyNotRead(const RequestHead& request) const {
  if (std::find(hosts_.begin(), hosts_.end(), request.host) != hosts_.end()) return {};
  return "Host '" + request.host + "' is not this server, expected " + hosts_.front();
}

std::string RequestRule::WhyNotCommand(const RequestHead& request) const {
  std::string why = WhyNotRead(request);
  if (!why.empty()) return why;
  if (request.origin != "http://" + request.host) {
    return "Origin '" + request.origin + "' may not command, expected the page of this server";
  }
  if (!EqualInConstantTime(request.token, token_)) {
    return "no valid token, expected the page's own in X-Sinew-Token";
  }
  return {};
}

bool RequestRule::IsOfThePage(const RequestHead& request) const {
  RequestHead own = request;
  if (own.origin.empty()) own.origin = "http://" + own.host;
  return WhyNotCommand(own).empty();
}

std::string RequestRule::TokenFor(const RequestHead& request) const {
  return request.from_loopback ? token_ : std::string();
}

}  // namespace sinew::live
