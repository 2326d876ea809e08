--- A box falls on the ground, as in bindings/c/falling_box.c, and ends with the same hash.
local ls = require("lockstep2d")

local out = ls.out("handle")
ls.world_new(nil, out)
local world = out[0]

local function add_rectangle(kind, half_width, half_height, y)
    local shape = ls.make("shape_def", ls.RECTANGLE)
    shape.points[0].x, shape.points[0].y = half_width, half_height
    local def, body = ls.make("body_def", kind), ls.out("body")
    def.position.y = y
    ls.spawn(world, def, shape, 1, body)
    return body[0]
end

add_rectangle(ls.FIXED, ls.fx(20), ls.fx(1), ls.fx(-1))
local box = add_rectangle(ls.DYNAMIC, ls.fx("0.25"), ls.fx("0.25"), ls.fx(3))
local info = require("ffi").new("ls2d_body_info")
for tick = 1, 120 do
    ls.world_step(world)
    if tick % 30 == 0 then
        ls.body_get(world, box, info)
        print(("tick %d: height %.6f m"):format(tick, ls.number(info.position.y)))
    end
end
local hash = ls.out("hash")
ls.world_hash(world, hash)
print(ls.hex(hash[0]))
ls.free(world)
