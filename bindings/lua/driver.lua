--- Two drivers play a match in one process: states stay equal while garbage is collected, and a key can be chosen.
local ffi = require("ffi")
local ls = require("lockstep2d")
local Driver = require("lockstep2d_match")
local Game = require("game")

-- Milliseconds between updates.
local INTERVAL = 4

--- Allocations after a collection reuse the memory of objects that nothing keeps alive.
local function collect()
    collectgarbage()
    local filled = {}
    for i = 1, 200 do
        filled[i] = ffi.new("uint64_t[2]", 0x5a5a5a5a5a5a5a5aULL, 0x5a5a5a5a5a5a5a5aULL)
    end
end

--- `latency(step)` is in steps of `INTERVAL`, 1 by default; `read(seats)` is random by default.
local function play(new_game, ticks, latency, read, guess)
    local peers, flying = {}, {}
    for index = 1, 2 do
        peers[index] = Driver.new({
            seats = Game.SEATS,
            offer = Game.OFFER,
            contact = index == 2 and "1" or nil,
            settings = {
                guess = guess or 6, start_with = Game.SEATS, key = index, check_interval = 1, save_interval = 1,
            },
            game = new_game(),
            send = function(to, packet)
                flying[#flying + 1] = { to = tonumber(to), from = tostring(index), packet = packet }
            end,
        })
    end
    local random = 1
    read = read or function()
        random = (random * 69069 + 1) % 4294967296
        return string.char(math.floor(random / 65536) % 8)
    end
    for step = 0, 100000 do
        local now, sent = step * INTERVAL / 1000, flying
        flying = {}
        for _, each in ipairs(sent) do
            each.at = each.at or step - 1 + (latency and latency(step) or 1)
            if each.at <= step then
                peers[each.to]:receive(now, each.from, each.packet)
            else
                flying[#flying + 1] = each
            end
        end
        for _, peer in ipairs(peers) do
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

-- Games of users may return a reference into memory that nothing keeps alive.
play(function()
    local game = Game.new()
    function game.hash()
        local hash = ls.out("hash")
        ls.world_hash(game.world, hash)
        return hash[0]
    end
    return game
end, 300)

-- Each result of `read` counts for one tick, while the input delay grows and shrinks.
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

-- The hash of the example is alive as long as its variable.
local game = Game.new()
local before = game:hash()
local text = ls.hex(before)
collect()
assert(ls.hex(before) == text, "the hash has changed after a collection")

-- A peer that returns to its seat passes its key and secret. The other numbers are random bytes.
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

print("driver: equal states in spite of garbage collections, and the chosen key")
