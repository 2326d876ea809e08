--- Two players over UDP, with rollback:
---
---     love examples/love --host 4000
---     love examples/love --join 127.0.0.1:4000
---
--- The keys are the arrows, or A, D and W; the space bar jumps, too. With `--guess N`, a player may be up to N ticks
--- ahead of the inputs of the other player (6 by default; 0 is lockstep). For tests: `--ticks N` on the host ends the
--- match after N ticks, `--random SEED` presses random keys, `--screenshot NAME` saves a picture at the end.
local ffi = require("ffi")
local socket = require("socket")
local ls = require("lockstep2d")
local Driver = require("lockstep2d_match")
local Game = require("game")

-- Pixels per metre.
local SCALE = 40
-- Maximum number of bodies in `rows`.
local ROWS = 64

local game, driver, udp, options, final_hash
local statuses = {}
for name, value in pairs(ls) do
    if type(name) == "string" and name:match("^MATCH_") then
        statuses[value] = name:sub(7):lower()
    end
end

local refusals = {
    [ls.REFUSED_OFFER] = "the other player has another version of the game",
    [ls.REFUSED_FULL] = "too many players are joining; start the game again",
    [ls.REFUSED_TAKEN] = "the other player has the same number by chance; start the game again",
}
-- Why this player cannot join, if so.
local refusal

local function parse(arguments)
    local parsed = { guess = "6" }
    for i = 1, #arguments, 2 do
        local name = arguments[i]:match("^%-%-(%a+)$")
        assert(name and arguments[i + 1], "options are --host PORT or --join ADDRESS:PORT, and those in main.lua")
        parsed[name] = arguments[i + 1]
    end
    assert(parsed.host or parsed.join, "pass --host PORT or --join ADDRESS:PORT")
    return parsed
end

local function send(to, packet)
    local address, port = to:match("^(.*):(%d+)$")
    udp:sendto(packet, address, tonumber(port))
end

function love.load(arguments)
    options = parse(arguments)
    udp = assert(socket.udp())
    udp:settimeout(0)
    assert(udp:setsockname("*", tonumber(options.host or 0)))
    game = Game.new()
    driver = Driver.new({
        seats = Game.SEATS,
        offer = Game.OFFER,
        contact = options.join,
        settings = { guess = tonumber(options.guess), start_with = Game.SEATS },
        game = game,
        send = send,
    })
    if options.random then
        love.math.setRandomSeed(tonumber(options.random))
    end
    if options.host and options.ticks then
        ls.match_end_at(driver.match, tonumber(options.ticks))
    end
end

local function read_keys()
    if options.random then
        return string.char(love.math.random(0, 7))
    end
    local down, keys = love.keyboard.isDown, 0
    keys = keys + (down("left", "a") and Game.LEFT or 0)
    keys = keys + (down("right", "d") and Game.RIGHT or 0)
    keys = keys + (down("up", "w", "space") and Game.JUMP or 0)
    return string.char(keys)
end

function love.update()
    local now = love.timer.getTime()
    local packet, address, port = udp:receivefrom()
    while packet do
        driver:receive(now, address .. ":" .. port, packet)
        packet, address, port = udp:receivefrom()
    end
    for _, event in ipairs(driver:update(now, read_keys)) do
        if event.kind == ls.EVENT_DESYNC then
            error("the states differ at tick " .. event.tick)
        elseif event.kind == ls.EVENT_REFUSED and refusals[event.value] then
            -- After another reason, the match asks again by itself.
            refusal = "refused: " .. refusals[event.value]
            print(refusal)
        end
    end
    local status = driver:status()
    local _, final = driver:ticks()
    -- Ticks whose inputs are final may still have to be played, so `driver.tick` is compared as well.
    if status == ls.MATCH_FINISHED and driver.tick == final and not final_hash then
        final_hash = ls.hex(game:hash())
        print(("%d ticks: %s"):format(driver.tick, final_hash))
        ls.match_leave(driver.match)
        if options.screenshot then
            love.graphics.captureScreenshot(options.screenshot)
        end
    elseif status == ls.MATCH_CLOSED then
        love.event.quit()
    end
end

local rows, count = ffi.new("double[?]", 5 * ROWS), ffi.new("size_t[1]")
local colours = { [2] = { 0.9, 0.4, 0.3 }, [3] = { 0.3, 0.6, 0.9 } }

function love.draw()
    local graphics = love.graphics
    graphics.clear(0.1, 0.11, 0.13)
    graphics.push()
    graphics.translate(graphics.getWidth() / 2, graphics.getHeight() - 80)
    graphics.scale(SCALE, -SCALE)
    graphics.setLineWidth(0.05)
    ls.draw_poses(game.world, rows, 5 * ROWS, count)
    for body = 1, tonumber(count[0]) / 5 do
        local row = rows + 5 * (body - 1)
        graphics.push()
        graphics.translate(row[1], row[2])
        graphics.rotate(row[3])
        graphics.setColor(colours[body] or (row[4] == 1 and { 0.8, 0.7, 0.5 } or { 0.5, 0.5, 0.5 }))
        if body == 1 then
            graphics.rectangle("line", -8, -1, 16, 2)
        elseif colours[body] then
            graphics.circle("line", 0, 0, 0.6)
            graphics.line(0, 0, 0.6, 0)
        else
            graphics.rectangle("line", -0.5, -0.5, 1, 1)
        end
        graphics.pop()
    end
    graphics.pop()
    graphics.setColor(1, 1, 1)
    local played, _, confirmed = driver:ticks()
    local text = "%s   tick %d, %d ahead of the confirmed inputs"
    graphics.print(refusal or text:format(statuses[driver:status()], played, played - confirmed), 10, 10)
end

local leaving = false

-- The first attempt to close the window leaves the match: the window stays open until the others have the inputs of
-- this player. The second attempt ends the program at once.
function love.quit()
    if leaving then
        return false
    end
    local status = driver:status()
    -- While this player is still connecting, there is no match to leave.
    if status ~= ls.MATCH_CLOSED and status ~= ls.MATCH_CONNECTING then
        ls.match_leave(driver.match)
        leaving = true
    end
    return leaving
end
