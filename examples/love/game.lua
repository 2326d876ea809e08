--- The rules: two players push crates over the edges. The whole state is the world.
local ffi = require("ffi")
local ls = require("lockstep2d")

local Game = {}
Game.__index = Game

Game.SEATS = 2
--- All peers have to agree on the rules and on the arithmetic of the engine.
Game.OFFER = "push the crates 1, semantics " .. ls.semantics()
Game.LEFT, Game.RIGHT, Game.JUMP = 1, 2, 4

-- The x coordinates in metres at which the players start.
local STARTS = { -5, 5 }

local function shape(kind, x, y, radius)
    local def = ls.make("shape_def", kind)
    def.points[0].x, def.points[0].y, def.radius = x, y, radius
    return def
end

local function spawn(world, kind, x, y, def)
    local body, id = ls.make("body_def", kind), ls.out("body")
    body.position.x, body.position.y = x, y
    ls.spawn(world, body, def, 1, id)
    return id[0]
end

function Game.new()
    local out = ls.out("handle")
    ls.world_new(nil, out)
    local self = setmetatable({ world = out[0], players = {}, info = ffi.new("ls2d_body_info"), out = out }, Game)
    local none = ls.fx(0)
    spawn(self.world, ls.FIXED, none, ls.fx(-1), shape(ls.RECTANGLE, ls.fx(8), ls.fx(1), none))
    for seat, x in ipairs(STARTS) do
        local disc = shape(ls.CIRCLE, none, none, ls.fx("0.6"))
        disc.density, disc.friction = ls.fx(3), ls.fx("0.9")
        self.players[seat] = spawn(self.world, ls.DYNAMIC, ls.fx(x), ls.fx(1), disc)
    end
    local half = ls.fx("0.5")
    for row = 0, 4 do
        for column = -1, 1 do
            local crate = shape(ls.RECTANGLE, half, half, none)
            spawn(self.world, ls.DYNAMIC, ls.fx(column) + half * (row % 2), ls.fx(row) + half, crate)
        end
    end
    return self
end

--- Plays a tick. `inputs` has one byte for each seat, with the bits `LEFT`, `RIGHT` and `JUMP`.
function Game:step(inputs)
    for seat, player in ipairs(self.players) do
        local input = inputs:byte(seat)
        ls.body_get(self.world, player, self.info)
        local along = bit.band(bit.rshift(input, 1), 1) - bit.band(input, 1)
        local vertical = self.info.velocity.y
        local stands = vertical < ls.fx("0.05") and vertical > ls.fx("-0.05")
        local up = stands and bit.band(input, Game.JUMP) ~= 0 and 18 or 0
        if along ~= 0 or up ~= 0 then
            local at = self.info.position
            ls.apply_impulse(self.world, player, ls.fx(along), ls.fx(up), at.x, at.y)
        end
        if self.info.position.y < ls.fx(-10) then
            ls.set_transform(self.world, player, ls.fx(STARTS[seat]), ls.fx(2), 0)
            ls.set_velocity(self.world, player, 0, 0, 0)
        end
    end
    ls.world_step(self.world)
end

function Game:save()
    ls.world_save(self.world, self.out)
    return self.out[0]
end

function Game:load(saved)
    ls.world_restore(self.world, saved)
end

function Game:drop(saved)
    ls.free(saved)
end

function Game:hash()
    -- `ls.out("hash")[0]` would be a reference into an array that LuaJIT may free when this function has returned.
    local hash = ffi.new("ls2d_hash")
    ls.world_hash(self.world, hash)
    return hash
end

function Game:encode()
    ls.world_encode(self.world, self.out)
    return ls.take_bytes(self.out[0])
end

function Game:decode(bytes)
    ls.world_decode(bytes, #bytes, self.out)
    ls.free(self.world)
    self.world = self.out[0]
end

return Game
