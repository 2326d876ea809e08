--- Plays a game in a match of `ls2d_match_host` or `ls2d_match_join`.
---
--- The game has
--- - `step(inputs, absent)`: advances by a tick. `inputs` is a string with the inputs of all seats in order, `absent`
---   has a bit for each empty seat;
--- - `save()` returns a copy of the whole state, `load(saved)` restores a copy, `drop(saved)` frees a copy;
--- - `hash()`: returns an `ls2d_hash` of the whole state. The driver copies the hash. `ls.world_hash` writes into an
---   `ffi.new("ls2d_hash")`;
--- - `encode()` returns the state as a string, `decode(bytes)` replaces the state by such a string, for peers that
---   join.
---
--- `send(to, packet)` sends a packet to an address. `to` and `packet` are strings.
local ffi = require("ffi")
local ls = require("lockstep2d")

local Driver = {}
Driver.__index = Driver

local ADDRESS_MAX, PACKET_MAX = 32, 2048
-- A time that lies at most this many seconds before an earlier time is not an error.
local BACK_MAX = 1

--- Random bytes of the system, which nobody can guess; nil if there are none.
local function random_bytes(count)
    if ffi.os == "Windows" then
        -- `RtlGenRandom`, which advapi32.dll exports by this name.
        ffi.cdef("unsigned char __stdcall SystemFunction036(void *bytes, unsigned long count);")
        local bytes = ffi.new("uint8_t[?]", count)
        return ffi.load("advapi32").SystemFunction036(bytes, count) ~= 0 and ffi.string(bytes, count) or nil
    end
    local file = io.open("/dev/urandom", "rb")
    local bytes = file and file:read(count)
    if file then
        file:close()
    end
    return bytes
end

--- Opens a match, or joins one through a `contact`, the address of a participant. `settings` are fields of
--- `ls2d_match_config`. All peers need the same `offer`, a string with rules and version. `random` is a string of 28
--- random bytes; it is required on systems that have no /dev/urandom and are not Windows. If `settings` lacks `peer`,
--- `key` or `secret`, the value is taken from the random bytes.
function Driver.new(options)
    local config = ls.make("match_config", options.seats)
    -- Random bytes for `peer`, `key` and `secret`, which must not be guessable.
    local random = options.random or random_bytes(28)
    if not random then
        error("this system has no source of random bytes: pass 28 of them as the option `random`", 2)
    end
    if #random ~= 28 then
        error("`random` has 28 bytes, and not " .. #random, 2)
    end
    ffi.copy(ffi.cast("uint8_t *", config) + ffi.offsetof(config, "peer"), random:sub(1, 4), 4)
    ffi.copy(ffi.cast("uint8_t *", config) + ffi.offsetof(config, "key"), random:sub(5), 24)
    -- Settings replace random values, because a peer that returns to its seat passes its own `key` and `secret`.
    for field, value in pairs(options.settings or {}) do
        config[field] = value
    end
    local handle, offer, contact = ls.out("handle"), options.offer, options.contact
    if contact then
        ls.match_join(config, offer, #offer, contact, #contact, handle)
    else
        ls.match_host(config, offer, #offer, handle)
    end
    local self = setmetatable({
        match = handle[0],
        game = options.game,
        send = options.send,
        tick = 0,
        saves = {},
        events = {},
        unissued = {},
        latest = 0,
        -- `pauses`: whether this peer requests a pause. `pausing`: the set of the other peers that request one.
        pauses = false,
        pausing = {},
        -- Whether the inputs of all ticks are final.
        finished = false,
        size = ffi.new("size_t[2]"),
        capacity = tonumber(config.seats * config.input_bytes),
        inputs = ffi.new("uint8_t[?]", config.seats * config.input_bytes),
        packet = ffi.new("uint8_t[?]", PACKET_MAX),
        address = ffi.new("uint8_t[?]", ADDRESS_MAX),
        request = ffi.new("ls2d_request"),
        event = ffi.new("ls2d_match_event"),
        flag = ffi.new("uint32_t[3]"),
    }, Driver)
    self:keep(0)
    return self
end

--- Requests a pause, or withdraws the request. While any player requests a pause, updates play no ticks and do not call
--- `read`; the program has to continue to call `update`. The other peers get the event `EVENT_PAUSE`. A request counts
--- only while the player has a seat: spectators and players that are still catching up with a running match cannot
--- pause the match.
function Driver:pause(paused)
    if type(paused) ~= "boolean" then
        error("`paused` is true or false, and not " .. tostring(paused), 2)
    end
    self.pauses = paused
    -- A peer that is still joining passes its request when it has received the state.
    if self:status() ~= ls.MATCH_CONNECTING then
        ls.match_pause(self.match, self.pauses and 1 or 0)
    end
end

--- Whether this peer or another player requests a pause.
function Driver:is_paused()
    -- Once all inputs are final, requests for a pause no longer count. Otherwise a player who quits during a pause
    -- would keep the other players from playing the last ticks.
    return not self.finished and (self.pauses and self:may_have_seat() or next(self.pausing) ~= nil)
end

-- A peer that joins a running match gets its seat after it has caught up. Until then, its own request for a pause does
-- not count, because a paused peer could not catch up.
function Driver:may_have_seat()
    return self:status() == ls.MATCH_CONNECTING or self:seat_count() > 0
end

--- Frees the saved states and the match. Every later use of the driver, except `close`, is an error.
function Driver:close()
    if self.match ~= 0 then
        self:forget(function() return true end)
        ls.free(self.match)
        self.match = 0
    end
end

-- Checks a time before it is passed to the match. A time that is only a little earlier than before is not an error: the
-- time of the match never decreases.
function Driver:check(now)
    if self.match == 0 then
        error("the driver is closed", 3)
    end
    if type(now) ~= "number" or not (now >= 0 and now < 2 ^ 53 / 1e6) then
        error("the time is a number of seconds from 0, and not " .. tostring(now), 3)
    end
    if now < self.latest - BACK_MAX then
        error(("the time is %g s, and was %g s before: it must not decrease"):format(now, self.latest), 3)
    end
    self.latest = math.max(self.latest, now)
end

--- Processes a packet that arrived from an address. `now` is in seconds, and must not decrease.
function Driver:receive(now, from, packet)
    self:check(now)
    ls.match_receive(self.match, now * 1e6, from, #from, packet, #packet)
end

--- Advances the match to the time `now` in seconds, and plays the ticks that are due. `read(seats)` returns the inputs
--- of this peer's seats as a string; `seats` is the number of these seats. Each result of `read` counts for one tick,
--- so clear recorded key presses in `read`. While the input delay grows, an update calls `read` several times. Returns
--- a list of events, whose fields are those of `ls2d_match_event`.
---
--- If `read` raises an error or returns inputs of a wrong length, the update first sends its packets and then raises
--- the error. The next update continues the match, and returns the events of both updates. After any other error, such
--- as an error of the game, every further update raises this error again. A time that is no number, or is more than a
--- second less than an earlier time, raises an error and changes nothing.
function Driver:update(now, read)
    local failure = self.failure
    if not failure then
        self:check(now)
        local done, result = pcall(self.run, self, now, read)
        if done and not result then
            local events = self.events
            self.events = {}
            return events
        end
        failure = done and result or { why = result }
        self.failure = not done and failure or nil
    end
    error(failure.why, 0)
end

function Driver:run(now, read)
    ls.match_update(self.match, now * 1e6)
    while ls.match_next_event(self.match, self.event) do
        local event = {}
        for _, field in ipairs({ "kind", "peer", "seat", "tick", "value" }) do
            event[field] = self.event[field]
        end
        -- Copies the hashes, because a field that is a struct is a reference into `self.event`.
        event.ours, event.theirs = ffi.new("ls2d_hash", self.event.ours), ffi.new("ls2d_hash", self.event.theirs)
        self.finished = self.finished or event.kind == ls.EVENT_STATUS and event.value == ls.MATCH_FINISHED
        if event.kind == ls.EVENT_PAUSE then
            self.pausing[event.peer] = event.value == 1 or nil
        end
        if event.kind == ls.EVENT_STATE then
            self:resume(event.tick, ls.take_bytes(event.value))
        end
        self.events[#self.events + 1] = event
    end
    self:fulfil()
    local failure = self:play(now, read)
    ls.match_wants_state(self.match, self.flag)
    if self.flag[0] == 1 then
        self:offer_state()
    end
    local size = self.size
    while ls.match_next_packet(self.match, self.address, ADDRESS_MAX, size, self.packet, PACKET_MAX, size + 1) do
        -- If `send` raises an error, the packet counts as lost in the network.
        local sent, why = pcall(self.send, ffi.string(self.address, size[0]), ffi.string(self.packet, size[1]))
        self.send_error = not sent and why or self.send_error
    end
    return failure
end

-- Plays the ticks that are due. Returns errors of `read` and of wrong inputs instead of raising them: no inputs were
-- issued, so the match can continue with the next inputs.
function Driver:play(now, read)
    while not self:is_paused() and self:is_due(now) do
        local seats = self:seat_count()
        local issued, before = false, self.tick
        local done, why = pcall(function()
            -- Inputs that were read but not issued are passed again, so that each key press counts exactly once.
            local inputs = self.unissued[seats] or (seats > 0 and read(seats) or "")
            self.unissued = {}
            ls.match_advance(self.match, now * 1e6, inputs, #inputs, self.flag)
            issued = self.flag[0] == 1
            self.unissued[seats] = not issued and inputs or nil
        end)
        if not done then
            return { why = why }
        end
        self:fulfil()
        if not issued and self.tick == before then
            return nil
        end
    end
end

function Driver:is_due(now)
    ls.match_is_due(self.match, now * 1e6, self.flag)
    return self.flag[0] == 1
end

--- Number of own seats.
function Driver:seat_count()
    local seats, count = ffi.new("uint64_t[1]"), 0
    ls.match_seats(self.match, seats)
    while seats[0] ~= 0 do
        seats[0] = bit.band(seats[0], seats[0] - 1)
        count = count + 1
    end
    return count
end

--- The status of the match: `ls.MATCH_PLAYING` and so on.
function Driver:status()
    ls.match_status(self.match, self.flag)
    return self.flag[0]
end

--- Returns three numbers of ticks: all ticks played, ticks with final inputs, and ticks played with final inputs. All
--- are 0 before the peer has joined.
function Driver:ticks()
    if self:status() == ls.MATCH_CONNECTING then
        return 0, 0, 0
    end
    ls.match_ticks(self.match, self.flag, self.flag + 1, self.flag + 2)
    return self.flag[0], self.flag[1], self.flag[2]
end

function Driver:keep(tick)
    self:forget(function(kept) return kept == tick end)
    -- Copies the hash, because the game may return a reference to an item of an array. LuaJIT frees the array although
    -- the reference exists.
    local hash = ffi.new("ls2d_hash[1]")
    hash[0] = self.game:hash()
    self.saves[tick] = { saved = self.game:save(), hash = hash }
end

function Driver:forget(condition)
    for tick, kept in pairs(self.saves) do
        if condition(tick) then
            self.game:drop(kept.saved)
            self.saves[tick] = nil
        end
    end
end

function Driver:resume(tick, state)
    self.game:decode(state)
    self.tick = tick
    self:forget(function() return true end)
    self:keep(tick)
    -- Requests of an earlier match of this peer do not count in this match.
    self.pausing, self.finished = {}, false
    ls.match_pause(self.match, self.pauses and 1 or 0)
end

--- The newest saved tick that is at most `tick`, or nil.
function Driver:newest(tick)
    local newest
    for kept in pairs(self.saves) do
        if kept <= tick and kept > (newest or -1) then
            newest = kept
        end
    end
    return newest
end

local answers = {
    [ls.REQUEST_SAVE] = function(self, tick)
        self:keep(tick)
    end,
    [ls.REQUEST_LOAD] = function(self, tick)
        self.game:load(self.saves[tick].saved)
        self:forget(function(kept) return kept > tick end)
        self.tick = tick
    end,
    [ls.REQUEST_ADVANCE] = function(self, tick)
        self.game:step(ffi.string(self.inputs, self.size[0]), self.request.absent)
        self.tick = tick + 1
    end,
    [ls.REQUEST_CHECKSUM] = function(self, tick)
        ls.match_report_hash(self.match, tick, self.saves[tick].hash)
    end,
    -- Keeps the newest state up to this tick, for peers that join.
    [ls.REQUEST_FORGET] = function(self, tick)
        local newest = self:newest(tick)
        self:forget(function(kept) return newest ~= nil and kept < newest end)
    end,
}

function Driver:fulfil()
    while ls.match_next_request(self.match, self.request, self.inputs, self.capacity, self.size) do
        answers[self.request.kind](self, self.request.tick)
    end
end

-- Offers the newest final state as bytes.
function Driver:offer_state()
    local _, _, confirmed = self:ticks()
    local tick = self:newest(confirmed)
    if not tick then
        return
    end
    local now = self.game:save()
    self.game:load(self.saves[tick].saved)
    local state = self.game:encode()
    self.game:load(now)
    self.game:drop(now)
    ls.match_offer_state(self.match, tick, state, #state)
end

return Driver
