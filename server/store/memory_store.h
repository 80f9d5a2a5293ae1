// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_STORE_MEMORY_STORE_H_
#define POSESPACE_STORE_MEMORY_STORE_H_

#include "store/store.h"

namespace posespace {

// A store that ends with the process.
class MemoryStore final : public Store {
 public:
  MemoryStore();
  ~MemoryStore() override;

  Result<std::vector<Entry>> List() const override;
  Result<void> Insert(const Entry& entry, std::span<const std::uint8_t> record) override;
  Result<void> Update(const std::string& id, std::span<const std::uint8_t> record,
                      std::span<const std::string> uses, std::span<const Blob> blobs) override;
  Result<void> Remove(const std::string& id) override;
  Result<Bytes> ReadRecord(const std::string& id) const override;
  Result<Bytes> ReadBlob(const std::string& key) const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_STORE_MEMORY_STORE_H_
