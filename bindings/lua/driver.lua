--- Tests of the driver. Two drivers play a match in one process, and their states stay equal while garbage is
--- collected.
local ffi = require("ffi")
local ls = require("lockstep2d")
local Driver = require("lockstep2d_match")
local Game = require("game")

-- Milliseconds between updates.
local INTERVAL = 4

--- Collects garbage, and overwrites the freed memory by new allocations, so that a dangling reference reads wrong
--- values.
local function collect()
    collectgarbage()
    local filled = {}
    for i = 1, 200 do
        filled[i] = ffi.new("uint64_t[2]", 0x5a5a5a5a5a5a5a5aULL, 0x5a5a5a5a5a5a5a5aULL)
    end
end

--- Makes two peers, and a function that delivers the packets between them. `changes` replaces some of the settings
--- below.
local function connect(new_game, changes)
    local peers, flying = {}, {}
    for index = 1, 2 do
        local settings = { guess = 6, start_with = Game.SEATS, key = index, check_interval = 1, save_interval = 1 }
        for field, value in pairs(changes or {}) do
            settings[field] = value
        end
        peers[index] = Driver.new({
            seats = Game.SEATS,
            offer = Game.OFFER,
            contact = index == 2 and "1" or nil,
            settings = settings,
            game = new_game(index),
            send = function(to, packet)
                flying[#flying + 1] = { to = tonumber(to), from = tostring(index), packet = packet }
            end,
        })
    end
    --- Delivers packets after `delay` steps.
    local function deliver(step, delay)
        local sent = flying
        flying = {}
        for _, each in ipairs(sent) do
            each.at = each.at or step - 1 + delay
            if each.at <= step then
                peers[each.to]:receive(step * INTERVAL / 1000, each.from, each.packet)
            else
                flying[#flying + 1] = each
            end
        end
    end
    return peers, deliver
end

--- Plays a match until both peers have played `ticks` ticks. `latency(step)` is in steps of `INTERVAL`, 1 by default.
--- `read` returns random inputs by default.
local function play(new_game, ticks, latency, read, guess)
    local peers, deliver = connect(new_game, { guess = guess })
    local random = 1
    read = read or function()
        random = (random * 69069 + 1) % 4294967296
        return string.char(math.floor(random / 65536) % 8)
    end
    for step = 0, 100000 do
        deliver(step, latency and latency(step) or 1)
        for _, peer in ipairs(peers) do
            local now = step * INTERVAL / 1000
            for _, event in ipairs(peer:update(now, function(seats) return read(seats, peer) end)) do
                assert(event.kind ~= ls.EVENT_DESYNC, "the states differ at tick " .. event.tick)
            end
        end
        collect()
        if peers[1].tick >= ticks and peers[2].tick >= ticks then
            return peers
        end
    end
    error("the match did not reach tick " .. ticks)
end

play(Game.new, 300)

-- `hash` of a game may return a reference to memory that the garbage collector then frees.
play(function()
    local game = Game.new()
    function game.hash()
        local hash = ls.out("hash")
        ls.world_hash(game.world, hash)
        return hash[0]
    end
    return game
end, 300)

-- Each result of `read` counts for exactly one tick, also while the input delay grows and shrinks.
local results, played = {}, {}
local function counting()
    local game = Game.new()
    local step = game.step
    function game:step(inputs, absent)
        played[game] = played[game] or {}
        table.insert(played[game], inputs:byte(1))
        return step(self, inputs, absent)
    end
    return game
end
local peers = play(counting, 900, function(step)
    return math.floor(step / 1500) % 2 == 0 and 5 or 40
end, function(_, peer)
    results[peer] = (results[peer] or -1) + 1
    return string.char(results[peer] % 8)
end, 0)
for tick, input in ipairs(played[peers[1].game]) do
    assert(input == (tick - 1) % 8, "tick " .. tick .. " has the input " .. input)
end

-- The hash that the example's game returns stays valid as long as a variable holds it.
local game = Game.new()
local before = game:hash()
local text = ls.hex(before)
collect()
assert(ls.hex(before) == text, "the hash has changed after a collection")

-- A peer that returns to its seat passes its own `key` and `secret`. The numbers that `settings` lacks are taken from
-- `random`.
local host, config = ls.match_host, nil
ls.match_host = function(given, ...)
    config = given
    return host(given, ...)
end
local function configure(settings)
    Driver.new({ seats = 1, offer = "", settings = settings, random = ("\1"):rep(28), game = Game.new(), send = print })
    return config
end
local plain, given = configure({}), configure({ peer = 7, key = 8, secret = { 9, 10 } })
local ones = 0x0101010101010101ULL
assert(plain.peer == 0x01010101 and plain.key == ones and plain.secret[0] == ones and plain.secret[1] == ones)
assert(given.peer == 7 and given.key == 8, "settings are overwritten")
assert(given.secret[0] == 9 and given.secret[1] == 10, "settings are overwritten")

ls.match_host = host

local function zero()
    return "\0"
end

local function raises(text, peer, step, read)
    local done, why = pcall(peer.update, peer, step * INTERVAL / 1000, read)
    assert(not done and tostring(why):match(text), tostring(why))
end

-- After an error of the game in a tick, the state of the game is not that of the match, so the driver plays no more
-- ticks.
local broken, steps = Game.new(), 0
function broken.step()
    steps = steps + 1
    assert(steps ~= 20, "the rules failed")
end
local alone = Driver.new({ seats = 1, offer = "", game = broken, send = print })
for step = 0, 1000 do
    if not pcall(alone.update, alone, step * INTERVAL / 1000, zero) then
        break
    end
end
for step = 1001, 1200 do
    raises("the rules failed", alone, step, zero)
end
assert(steps == 20 and alone.tick == 19, steps .. " steps, tick " .. alone.tick)

-- While `read` fails, the driver keeps the events for the next update that succeeds, and other peers can join.
for text, wrong in pairs({
    ["no gamepad"] = function() error("no gamepad") end,
    ["ls2d_match_advance"] = function() return "\0\0" end,
}) do
    local both, deliver = connect(Game.new, { start_with = 1 })
    local failures, seats = 0, {}
    local function step_all(from, to, read)
        for step = from, to do
            deliver(step, 1)
            local done, result = pcall(both[1].update, both[1], step * INTERVAL / 1000, read)
            assert(done or tostring(result):match(text), tostring(result))
            failures = failures + (done and 0 or 1)
            for _, event in ipairs(done and result or {}) do
                seats[event.kind == ls.EVENT_SEATED and event.seat or event.kind] = event.kind
            end
            both[2]:update(step * INTERVAL / 1000, zero)
        end
    end
    step_all(0, 300, wrong)
    assert(both[1].tick == 0 and failures > 200, failures .. " failures")
    assert(both[2]:status() ~= ls.MATCH_CONNECTING, "nobody can join")
    step_all(301, 900, zero)
    assert(both[1].tick > 60, "tick " .. both[1].tick)
    assert(both[1]:status() == ls.MATCH_PLAYING and both[2]:status() == ls.MATCH_PLAYING)
    assert(seats[1] == ls.EVENT_SEATED, "the seat of the guest")
end

-- A desync event has the hashes of both states.
local both, deliver = connect(function(index)
    local game = Game.new()
    function game.hash()
        return ffi.new("ls2d_hash", index, 7)
    end
    return game
end)
local desyncs = {}
for step = 0, 500 do
    deliver(step, 1)
    for index, peer in ipairs(both) do
        for _, event in ipairs(peer:update(step * INTERVAL / 1000, zero)) do
            if event.kind == ls.EVENT_DESYNC then
                assert(desyncs[index] == nil, "one event in each match")
                desyncs[index] = event
            end
        end
    end
    collect()
end
for index, event in pairs(desyncs) do
    local other = 3 - index
    assert(event.ours.low == index and event.theirs.low == other and event.ours.high == 7, ls.hex(event.ours))
    assert(event.peer ~= 0)
end
assert(desyncs[1] or desyncs[2], "the states differ")

-- While a player requests a pause, all players wait and keep their seats. Afterwards, the driver does not play
-- additional ticks to catch up with the time of the pause.
both, deliver = connect(Game.new, { guess = 6 })
local seen = {}
local function run(from, to, read)
    for step = from, to do
        deliver(step, 3)
        for index, peer in ipairs(both) do
            for _, event in ipairs(peer:update(step * INTERVAL / 1000, read or zero)) do
                assert(event.kind ~= ls.EVENT_UNSEATED and event.kind ~= ls.EVENT_DESYNC, "event " .. event.kind)
                if event.kind == ls.EVENT_PAUSE then
                    seen[#seen + 1] = index .. " " .. event.value
                end
            end
        end
    end
end
run(0, 500)
assert(not pcall(both[1].pause, both[1], 0), "0 is true in Lua")
both[1]:pause(true)
run(501, 550)
assert(both[1]:is_paused() and both[2]:is_paused())
local ticks = { both[1].tick, both[2].tick }
assert(ticks[1] > 60)
-- These 750 steps take three seconds, which is longer than the patience.
run(551, 1300, function() error("no inputs are read during a pause") end)
both[2]:pause(true)
run(1301, 1350)
both[1]:pause(false)
run(1351, 1500)
assert(both[1]:is_paused() and both[2]:is_paused(), "the other player has not ended the pause")
assert(both[1].tick == ticks[1] and both[2].tick == ticks[2])
both[2]:pause(false)
run(1501, 1750)
assert(not both[1]:is_paused() and not both[2]:is_paused())
for index, peer in ipairs(both) do
    local ticks_since = peer.tick - ticks[index]
    assert(ticks_since > 30 and ticks_since < 75, ticks_since .. " ticks in a second")
    assert(peer:status() == ls.MATCH_PLAYING)
end
assert(table.concat(seen, ", ") == "2 1, 1 1, 2 0, 1 0", table.concat(seen, ", "))

-- A wrong time raises an error, and the match goes on. The time of a frame may be a little less than an earlier time.
for _, wrong in ipairs({ 0 / 0, -1, math.huge, "7", 3 }) do
    for _, name in ipairs({ "update", "receive" }) do
        local done, why = pcall(both[1][name], both[1], wrong, name == "update" and zero or "2", "packet")
        assert(not done and why:match("the time is"), tostring(why))
    end
end
local tick = both[1].tick
both[1]:update(1740 * INTERVAL / 1000, zero)
run(1751, 2000)
assert(both[1].tick > tick + 30, "tick " .. both[1].tick)

-- On Windows, random bytes come from advapi32.dll. This is a stand-in for it: the test does not run on Windows.
local function random_key(os, load, open)
    local real = { ffi.os, ffi.load, io.open }
    ffi.os, ffi.load, io.open = os, load, open
    local done, made = pcall(Driver.new, { seats = 1, offer = "", game = Game.new(), send = print })
    ffi.os, ffi.load, io.open = unpack(real)
    if not done then
        return made
    end
    made:close()
end
for _, result in ipairs({ 1, 0 }) do
    local filled = 0
    local why = random_key("Windows", function(name)
        assert(name == "advapi32", name)
        return { SystemFunction036 = function(bytes, count)
            ffi.fill(bytes, count, 7)
            filled = filled + count
            return result
        end }
    end)
    assert(filled == 28 and (result == 1) == (why == nil), tostring(why))
end
local none = random_key("BSD", nil, function() end)
assert(tostring(none):match("pass 28 of them as the option `random`"), tostring(none))

-- A closed driver frees its saves and its match.
local objects = tonumber(ls.object_count())
local one = { start_with = 1 }
local closed = Driver.new({ seats = Game.SEATS, offer = "", settings = one, game = Game.new(), send = print })
for step = 0, 200 do
    closed:update(step * INTERVAL / 1000, zero)
end
closed:close()
closed:close()
assert(tonumber(ls.object_count()) == objects + 1, "only the world is left")
raises("the driver is closed", closed, 201, zero)

print("driver: equal states, the chosen key, errors, fields of events, pauses and wrong times")
