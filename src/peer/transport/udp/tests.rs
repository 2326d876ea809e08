use super::*;

#[test]
fn an_address_has_one_form() {
    let plain: SocketAddr = "10.1.2.3:7000".parse().unwrap();
    let mapped: SocketAddr = "[::ffff:10.1.2.3]:7000".parse().unwrap();
    assert_eq!(socket_address(plain), socket_address(mapped));
    for address in ["10.1.2.3:7000", "[2001:db8::1]:9", "[fe80::1%3]:9", "[fe80::1]:9"] {
        let address: SocketAddr = address.parse().unwrap();
        assert_eq!(to_socket(&socket_address(address)), Some(address));
    }
    assert_eq!(to_socket(&Address::new(&[1, 2, 3]).unwrap()), None);
}

#[test]
fn sockets_of_both_families_reach_each_other() {
    let mut v4 = Udp::bind("127.0.0.1:0").unwrap();
    let Ok(mut v6) = Udp::bind("[::]:0") else { return };
    let port = v6.local_address().unwrap().port();
    let to = socket_address(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
    v4.send(&[1, 2, 3], &to);
    let mut received = None;
    for _ in 0..1000 {
        received = v6.receive();
        if received.is_some() {
            break;
        }
        std::thread::sleep(core::time::Duration::from_millis(1));
    }
    let own = socket_address(v4.local_address().unwrap());
    assert_eq!(received, Some((own, vec![1, 2, 3])));
}
