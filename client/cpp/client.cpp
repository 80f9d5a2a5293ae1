// SPDX-License-Identifier: Apache-2.0
#include "posespace/client.h"

#include <cstdio>
#include <random>

#include "client/cpp/channel.h"
#include "client/cpp/session_handle.h"
#include "posespace/v1/session_service.pb.h"

namespace posespace {
namespace {

constexpr int kPage = 1'000;  // the most that the service lists at once

// 128 random bits: makes the retry of a call known as one.
std::string RequestId() {
  std::random_device random;
  std::string id;
  for (int k = 0; k < 4; ++k) {
    char digits[9];
    std::snprintf(digits, sizeof(digits), "%08x", static_cast<unsigned>(random()));
    id += digits;
  }
  return id;
}

}  // namespace

Client::Client(const std::string& address, const ClientOptions& options)
    : channel_(std::make_shared<internal::Channel>(address, options)) {}

void Client::Ping() const { channel_->CheckHealth(); }

Session Client::CreateSession(const std::string& session_id, const std::string& display_name,
                              const std::map<std::string, std::string>& labels) const {
  v1::CreateSessionRequest request;
  request.set_session_id(session_id);
  request.set_display_name(display_name);
  request.mutable_labels()->insert(labels.begin(), labels.end());
  request.set_request_id(RequestId());
  v1::CreateSessionResponse response;
  channel_->Call(request, &response);
  return posespace::Session(
      std::make_shared<internal::SessionHandle>(channel_, response.session().id()));
}

Session Client::Session(const std::string& session_id) const {
  posespace::Session session(std::make_shared<internal::SessionHandle>(channel_, session_id));
  session.State();
  return session;
}

std::vector<Session> Client::Sessions() const {
  std::vector<posespace::Session> sessions;
  v1::ListSessionsRequest request;
  v1::ListSessionsResponse page;
  request.set_page_size(kPage);
  do {
    channel_->Call(request, &page);
    for (const v1::Session& message : page.sessions()) {
      sessions.push_back(
          posespace::Session(std::make_shared<internal::SessionHandle>(channel_, message.id())));
    }
    request.set_page_token(page.next_page_token());
  } while (!page.next_page_token().empty());
  return sessions;
}

}  // namespace posespace
