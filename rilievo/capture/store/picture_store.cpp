#include "rilievo/capture/store/picture_store.h"

#include <sqlite3.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "rilievo/capture/store/content_hash.h"
#include "rilievo/capture/store/picture_bytes.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo {
namespace {

// "RLVS": whose file it is. And the version of its tables:
//   1  pictures: key, size, hash; texels: the bytes
//   2  and when a picture was last used, for letting the others go
constexpr int kApplicationId = 0x524C5653, kSchema = 2;

constexpr const char* kTables = R"(
  CREATE TABLE pictures (
    id INTEGER PRIMARY KEY,
    content TEXT NOT NULL, shader TEXT NOT NULL, cell TEXT NOT NULL,
    width INTEGER NOT NULL, height INTEGER NOT NULL,
    size INTEGER NOT NULL, hash TEXT NOT NULL,
    used INTEGER NOT NULL DEFAULT 0,
    UNIQUE (content, shader, cell, width, height));
  CREATE TABLE texels (id INTEGER PRIMARY KEY, bytes BLOB NOT NULL);
  CREATE INDEX pictures_used ON pictures (used, size);)";
// From schema 1: the older a picture, the longer it has not been used.
constexpr const char* kMigration = R"(
  ALTER TABLE pictures ADD COLUMN used INTEGER NOT NULL DEFAULT 0;
  UPDATE pictures SET used = id;
  CREATE INDEX pictures_used ON pictures (used, size);)";

// What SQLite says to a statement; caught within this file.
struct SqlFailure {
  int code;
  std::string reason;
};

class Statement {
 public:
  Statement(sqlite3* db, const char* sql) : db_(db) {
    check(sqlite3_prepare_v2(db, sql, -1, &statement_, nullptr));
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(const std::string& text) {
    check(sqlite3_bind_text(statement_, ++bound_, text.data(), int(text.size()), SQLITE_TRANSIENT));
    return *this;
  }
  Statement& bind(std::int64_t number) {
    check(sqlite3_bind_int64(statement_, ++bound_, number));
    return *this;
  }
  Statement& bind(const PictureKey& key) {
    return bind(key.content).bind(key.shader).bind(key.cell).bind(key.width).bind(key.height);
  }
  // The bytes must outlive the statement.
  Statement& bind(std::span<const std::byte> bytes) {
    check(sqlite3_bind_blob64(statement_, ++bound_, bytes.data(), bytes.size(), SQLITE_STATIC));
    return *this;
  }
  // Is there another row?
  bool step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) check(code);
    return code == SQLITE_ROW;
  }
  [[nodiscard]] std::int64_t number(int column) const {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] std::string text(int column) const {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return text ? text : "";
  }
  [[nodiscard]] std::vector<std::byte> bytes(int column) const {
    const auto* from = static_cast<const std::byte*>(sqlite3_column_blob(statement_, column));
    return from ? std::vector<std::byte>(from, from + sqlite3_column_bytes(statement_, column))
                : std::vector<std::byte>();
  }

 private:
  void check(int code) const {
    if (code != SQLITE_OK) throw SqlFailure{code, sqlite3_errmsg(db_)};
  }
  sqlite3* db_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

void execute(sqlite3* db, const char* sql) {
  if (const int code = sqlite3_exec(db, sql, nullptr, nullptr, nullptr); code != SQLITE_OK)
    throw SqlFailure{code, sqlite3_errmsg(db)};
}

std::int64_t number_of(sqlite3* db, const char* sql) {
  Statement statement(db, sql);
  return statement.step() ? statement.number(0) : 0;
}

// All or nothing.
class Transaction {
 public:
  Transaction(sqlite3* db, const char* begin) : db_(db) { execute(db, begin); }
  ~Transaction() {
    if (db_) sqlite3_exec(db_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit() {
    execute(db_, "COMMIT");
    db_ = nullptr;
  }

 private:
  sqlite3* db_;
};
constexpr const char* kRead = "BEGIN";
constexpr const char* kWrite = "BEGIN IMMEDIATE";  // waits here, and nowhere later

void remove_picture(sqlite3* db, std::int64_t id) {
  Statement(db, "DELETE FROM texels WHERE id = ?").bind(id).step();
  Statement(db, "DELETE FROM pictures WHERE id = ?").bind(id).step();
}

std::int64_t stored_bytes(sqlite3* db) {
  return number_of(db, "SELECT coalesce(sum(size), 0) FROM pictures");
}

// Lets the least recently used pictures go until the others fit; `keep` stays.
std::uint64_t evict(sqlite3* db, std::uint64_t max_bytes, std::int64_t keep) {
  std::uint64_t gone = 0;
  for (std::int64_t bytes = stored_bytes(db); std::uint64_t(bytes) > max_bytes; ++gone) {
    Statement oldest(db, "SELECT id, size FROM pictures WHERE id <> ? ORDER BY used, id LIMIT 1");
    oldest.bind(keep);
    if (!oldest.step()) break;
    bytes -= oldest.number(1);
    remove_picture(db, oldest.number(0));
  }
  return gone;
}

// Why the file is not ours to use; empty if it is, or if it is new.
std::string refusal(sqlite3* db, bool& is_new) {
  const std::int64_t id = number_of(db, "PRAGMA application_id");
  const std::int64_t version = number_of(db, "PRAGMA user_version");
  is_new = id == 0 && version == 0 && number_of(db, "SELECT count(*) FROM sqlite_master") == 0;
  if (is_new) return {};
  if (id != kApplicationId) return "is a database of another program, not a store of pictures";
  if (version > kSchema)
    return "is a store of a newer version (its schema is " + std::to_string(version) +
           ", this program knows " + std::to_string(kSchema) + ")";
  if (version < 1) return "is a store without a version";
  return {};
}

// Makes the file a store of ours, with pictures of at most `max_bytes`. Why it cannot be one; empty
// if it is.
std::string set_up(sqlite3* db, std::uint64_t max_bytes, std::uint64_t& evicted) {
  bool is_new = false;
  {
    // One view of the file: read one by one, its marks could be from before and after another
    // process has made the tables.
    Transaction one_view(db, kRead);
    if (std::string reason = refusal(db, is_new); !reason.empty()) return reason;
  }
  if (is_new) execute(db, "PRAGMA page_size = 16384; PRAGMA auto_vacuum = INCREMENTAL");
  execute(db, "PRAGMA journal_mode = WAL");
  // A killed process loses nothing that it has committed.
  execute(db, "PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = OFF");
  Transaction all(db, kWrite);
  // Somebody else may have been here meanwhile.
  if (std::string reason = refusal(db, is_new); !reason.empty()) return reason;
  const std::int64_t version = number_of(db, "PRAGMA user_version");
  if (is_new) execute(db, kTables);
  if (version == 1) execute(db, kMigration);
  if (version != kSchema)
    execute(db, ("PRAGMA application_id = " + std::to_string(kApplicationId) +
                 "; PRAGMA user_version = " + std::to_string(kSchema))
                    .c_str());
  evicted = evict(db, max_bytes, -1);
  all.commit();
  return {};
}

// The same again where SQLite finds the file busy without waiting for it, as it does while others
// change its kind of log: a file in its first moments is opened by several at once.
std::string set_up_in_time(sqlite3* db, const StoreOptions& options, std::uint64_t& evicted) {
  const Stopwatch watch;
  while (true) {
    try {
      return set_up(db, options.max_bytes, evicted);
    } catch (const SqlFailure& failure) {
      if (failure.code != SQLITE_BUSY || watch.ms() > 1e3 * options.wait_s) throw;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
}

}  // namespace

std::string camera_cell(const Camera& camera, double size, int aim) {
  RILIEVO_EXPECTS(size > 0);
  std::string out = std::to_string(int(camera.projection));
  for (int axis = 0; axis < 3; ++axis)
    out += ' ' + std::to_string(std::int64_t(
                     std::clamp(std::floor(camera.position()[axis] / size), -9e18, 9e18)));
  return out + ' ' + std::to_string(size) + ' ' + std::to_string(aim);
}

struct PictureStore::State {
  std::string path;
  StoreOptions options;
  sqlite3* db = nullptr;
  mutable std::mutex mutex;
  StoreStats stats;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { sqlite3_close(db); }

  [[nodiscard]] Error error(const SqlFailure& failure) const {
    return {path, failure.code == SQLITE_NOTADB ? "is not a store of pictures"
                                                : "the store fails: " + failure.reason};
  }
};

PictureStore::PictureStore(std::unique_ptr<State> state) : state_(std::move(state)) {}
PictureStore::PictureStore(PictureStore&&) noexcept = default;
PictureStore& PictureStore::operator=(PictureStore&&) noexcept = default;
PictureStore::~PictureStore() = default;

Result<PictureStore> PictureStore::open(const std::filesystem::path& path,
                                        const StoreOptions& options) {
  auto state = std::make_unique<State>();
  state->path = path.string();
  state->options = options;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return Error{state->path, "is a folder"};
  if (sqlite3_open_v2(state->path.c_str(), &state->db,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX,
                      nullptr) != SQLITE_OK)
    return Error{state->path, std::string("cannot be opened as a store of pictures: ") +
                                  (state->db ? sqlite3_errmsg(state->db) : "out of memory")};
  sqlite3* db = state->db;
  sqlite3_busy_timeout(db, int(std::clamp(options.wait_s * 1000, 0.0, 2e9)));
  try {
    if (const std::string reason = set_up_in_time(db, options, state->stats.evicted);
        !reason.empty())
      return Error{state->path, reason};
    if (state->stats.evicted > 0) execute(db, "PRAGMA incremental_vacuum");
  } catch (const SqlFailure& failure) {
    return state->error(failure);
  }
  return PictureStore(std::move(state));
}

Result<std::optional<DepthImage>> PictureStore::find(const PictureKey& key) {
  State& s = *state_;
  const std::lock_guard lock(s.mutex);
  try {
    std::int64_t id = 0;
    std::string hash;
    std::vector<std::byte> bytes;
    {
      Transaction both(s.db, kRead);
      Statement row(s.db,
                    "SELECT id, hash FROM pictures WHERE content = ? AND shader = ? AND cell = ? "
                    "AND width = ? AND height = ?");
      if (!row.bind(key).step()) {
        ++s.stats.missed;
        return std::optional<DepthImage>();
      }
      id = row.number(0);
      hash = row.text(1);
      Statement texels(s.db, "SELECT bytes FROM texels WHERE id = ?");
      if (texels.bind(id).step()) bytes = texels.bytes(0);
    }
    ContentHash found;
    found.add(bytes);
    std::optional<DepthImage> picture;
    if (found.text() == hash) picture = picture_from_bytes(bytes);
    if (!picture) {
      ++s.stats.damaged, ++s.stats.missed;
      Transaction all(s.db, kWrite);
      // Unless somebody has replaced it meanwhile.
      Statement same(s.db, "SELECT 1 FROM pictures WHERE id = ? AND hash = ?");
      if (same.bind(id).bind(hash).step()) remove_picture(s.db, id);
      all.commit();
      return picture;
    }
    ++s.stats.found;
    // That it was used is worth no wait for others, and no failure.
    try {
      sqlite3_busy_timeout(s.db, 0);
      Statement(s.db,
                "UPDATE pictures SET used = (SELECT max(used) + 1 FROM pictures) WHERE id = ?")
          .bind(id)
          .step();
    } catch (const SqlFailure&) {
    }
    sqlite3_busy_timeout(s.db, int(std::clamp(s.options.wait_s * 1000, 0.0, 2e9)));
    return picture;
  } catch (const SqlFailure& failure) {
    return s.error(failure);
  }
}

Result<> PictureStore::insert(const PictureKey& key, const DepthImage& picture) {
  State& s = *state_;
  const std::vector<std::byte> bytes = picture_bytes(picture);
  if (bytes.size() > s.options.max_bytes) return Done{};
  ContentHash hash;
  hash.add(bytes);
  const std::lock_guard lock(s.mutex);
  try {
    Transaction all(s.db, kWrite);
    {
      Statement old(s.db,
                    "SELECT id FROM pictures WHERE content = ? AND shader = ? AND cell = ? AND "
                    "width = ? AND height = ?");
      if (old.bind(key).step()) remove_picture(s.db, old.number(0));
    }
    Statement(s.db,
              "INSERT INTO pictures (content, shader, cell, width, height, size, hash, used) "
              "VALUES (?, ?, ?, ?, ?, ?, ?, "
              "(SELECT coalesce(max(used), 0) + 1 FROM pictures))")
        .bind(key)
        .bind(std::int64_t(bytes.size()))
        .bind(hash.text())
        .step();
    const std::int64_t id = sqlite3_last_insert_rowid(s.db);
    Statement(s.db, "INSERT OR REPLACE INTO texels (id, bytes) VALUES (?, ?)")
        .bind(id)
        .bind(std::span<const std::byte>(bytes))
        .step();
    const std::uint64_t gone = evict(s.db, s.options.max_bytes, id);
    all.commit();
    s.stats.evicted += gone, ++s.stats.stored;
  } catch (const SqlFailure& failure) {
    return s.error(failure);
  }
  return Done{};
}

Result<std::uint64_t> PictureStore::bytes() {
  const std::lock_guard lock(state_->mutex);
  try {
    return std::uint64_t(stored_bytes(state_->db));
  } catch (const SqlFailure& failure) {
    return state_->error(failure);
  }
}

Result<std::uint64_t> PictureStore::count() {
  const std::lock_guard lock(state_->mutex);
  try {
    return std::uint64_t(number_of(state_->db, "SELECT count(*) FROM pictures"));
  } catch (const SqlFailure& failure) {
    return state_->error(failure);
  }
}

StoreStats PictureStore::stats() const {
  const std::lock_guard lock(state_->mutex);
  return state_->stats;
}

}  // namespace rilievo
